#include "simplify/cut_off.h"

#include "geometry/union_find.h"
#include "mesh/adjacency.h"

#include <algorithm>
#include <utility>

namespace quoin {
namespace {

// Floods grow face by face, in turn, from every face beside what was taken out, and become one where they meet. All but
// one have come to their end when they are known to be pieces.
class Floods {
public:
    Floods(const std::vector<PlaneId>& zone_of, const std::vector<std::uint32_t>& opposite,
           std::span<const FaceId> beside, std::vector<std::uint32_t>& mark)
        : zone_of_(zone_of), opposite_(opposite), mark_(mark), joined_(beside.size()), flood_(beside.size())
    {
        for (std::uint32_t i = 0; i < beside.size(); ++i)
            reach(i, beside[i]);
    }
    ~Floods()
    {
        for (const Flood& flood : flood_)
            for (const FaceId f : flood.face)
                mark_[f] = 0;
    }

    std::vector<std::vector<FaceId>> run()
    {
        std::vector<std::uint32_t> open(flood_.size());
        for (std::uint32_t i = 0; i < open.size(); ++i)
            open[i] = i;
        const auto is_done = [&](std::uint32_t i) { return !joined_.is_root(i) || flood_[i].next == size(i); };
        while (std::erase_if(open, is_done), open.size() > 1)
            for (const std::uint32_t i : open)
                if (!is_done(i)) grow(i);
        return pieces(open);
    }

private:
    struct Flood {
        std::vector<FaceId> face; // reached
        std::size_t next = 0;     // the first of them whose neighbours have not been looked at
    };

    std::size_t size(std::uint32_t i) const { return flood_[i].face.size(); }

    void reach(std::uint32_t i, FaceId f)
    {
        if (mark_[f] == 0) {
            mark_[f] = i + 1;
            flood_[i].face.push_back(f);
        } else
            join(i, joined_.find(mark_[f] - 1));
    }

    void join(std::uint32_t i, std::uint32_t other)
    {
        if (i == other) return;
        const auto [root, child] = size(i) >= size(other) ? std::pair(i, other) : std::pair(other, i);
        joined_.join(root, child);
        Flood &all = flood_[root], &part = flood_[child];
        const auto looked_at = part.face.begin() + static_cast<std::ptrdiff_t>(part.next);
        all.face.insert(all.face.begin() + static_cast<std::ptrdiff_t>(all.next), part.face.begin(), looked_at);
        all.next += part.next;
        all.face.insert(all.face.end(), looked_at, part.face.end());
        part = {};
    }

    void grow(std::uint32_t i)
    {
        const FaceId f = flood_[i].face[flood_[i].next++];
        for (std::uint32_t h = 3 * f; h < 3 * f + 3; ++h) {
            const std::uint32_t o = opposite_[h];
            if (is_half_edge(o) && zone_of_[o / 3] == zone_of_[f]) reach(joined_.find(i), o / 3);
        }
    }

    // All that have come to their end, but for the largest if all have.
    std::vector<std::vector<FaceId>> pieces(const std::vector<std::uint32_t>& open)
    {
        std::vector<std::uint32_t> root;
        for (std::uint32_t i = 0; i < flood_.size(); ++i)
            if (joined_.is_root(i) && std::ranges::find(open, i) == open.end()) root.push_back(i);
        if (open.empty() && !root.empty())
            root.erase(std::ranges::max_element(root, {}, [&](std::uint32_t i) { return size(i); }));
        std::vector<std::vector<FaceId>> pieces;
        for (const std::uint32_t i : root) {
            pieces.push_back(flood_[i].face);
            std::ranges::sort(pieces.back());
        }
        return pieces;
    }

    const std::vector<PlaneId>& zone_of_;
    const std::vector<std::uint32_t>& opposite_;
    std::vector<std::uint32_t>& mark_; // F; a flood + 1
    UnionFind joined_;                 // floods
    std::vector<Flood> flood_;         // at the roots
};

} // namespace

std::vector<std::vector<FaceId>> cut_off_pieces(const std::vector<PlaneId>& zone_of,
                                                const std::vector<std::uint32_t>& opposite,
                                                std::span<const FaceId> beside, std::vector<std::uint32_t>& mark)
{
    return Floods(zone_of, opposite, beside, mark).run();
}

} // namespace quoin
