#include "mesh/flip_guard.h"

#include "base/parallel.h"
#include "mesh/adjacency.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

namespace quoin {
namespace {

constexpr std::size_t kFlipGrain = 1 << 13;

using Positions = std::vector<Eigen::Vector3f>;
using Flags = std::vector<std::uint8_t>;

// How a face and its edges lie; the larger, the better.
struct Posture {
    float facing = 0.0f;                           // cosine between the face and its plane, -1 without area
    float shape = 0.0f;                            // height over longest edge
    std::array<float, 3> unfold{1.0f, 1.0f, 1.0f}; // cosine to the face across an edge, 1 where there is not one
};

// What must hold from now on. Faces folded already may fold further: else they would hold back all around them.
Posture least(Posture before, const FlipLimits& limits)
{
    constexpr float kOfSliver = 0.5f; // part of its shape that a sliver keeps
    before.facing = std::min(before.facing, static_cast<float>(limits.min_cosine));
    before.shape = std::min(kOfSliver * before.shape, static_cast<float>(limits.min_shape));
    for (auto& unfold : before.unfold)
        unfold = unfold < static_cast<float>(limits.folded_cosine) ? -1.0f : static_cast<float>(limits.folded_cosine);
    return before;
}

// Looks at faces with moved vertices alone, and again only at those whose vertices it has pulled.
class FlipGuard {
public:
    FlipGuard(PlaneMesh& mesh, const Positions& before, const FlipLimits& limits, int halvings)
        : mesh_(mesh), before_(before), wanted_(mesh.mesh.position), halvings_(halvings),
          opposite_(opposite_half_edges(mesh.mesh)), halved_(before.size(), 0), moved_(before.size(), 0)
    {
        find_moved_faces();
        mesh_.mesh.position = before_;
        measure(Flags(before.size(), 1));
        least_ = posture_;
        for (auto& posture : least_)
            posture = least(posture, limits);
        mesh_.mesh.position = wanted_;
    }

    std::size_t run()
    {
        Flags pulled = moved_;
        do {
            measure(pulled);
            pulled = guilty(pulled);
        } while (pull_back(pulled));
        return static_cast<std::size_t>(
            std::count_if(halved_.begin(), halved_.end(), [](auto times) { return times > 0; }));
    }

private:
    static constexpr std::uint32_t kStill = 0xffffffffu; // the slot of a face without moved vertices

    void find_moved_faces();
    bool touched(FaceId f, const Flags& pulled) const
    {
        const Face& face = mesh_.mesh.face[f];
        return (pulled[face[0]] | pulled[face[1]] | pulled[face[2]]) != 0;
    }
    Eigen::Vector3d normal(FaceId f) const
    {
        return slot_[f] == kStill ? face_normal(mesh_.mesh, f) : normal_[slot_[f]];
    }
    void measure(const Flags& pulled);
    void measure_edges(std::uint32_t slot);
    Flags guilty(const Flags& pulled) const;
    bool pull_back(const Flags& guilty);

    PlaneMesh& mesh_;
    const Positions& before_;
    const Positions wanted_;
    const int halvings_;
    const std::vector<std::uint32_t> opposite_;
    Flags halved_;                        // times, one a vertex; more than halvings_ is all the way back
    Flags moved_;                         // one a vertex
    std::vector<FaceId> face_;            // with moved vertices
    std::vector<std::uint32_t> slot_;     // F; where a face is among these
    std::vector<Eigen::Vector3d> normal_; // one a slot
    std::vector<Posture> posture_, least_;
};

void FlipGuard::find_moved_faces()
{
    for (VertexId v = 0; v < before_.size(); ++v)
        moved_[v] = wanted_[v] == before_[v] ? 0 : 1;
    slot_.assign(mesh_.mesh.face.size(), kStill);
    for (FaceId f = 0; f < slot_.size(); ++f) {
        if (!touched(f, moved_)) continue;
        slot_[f] = static_cast<std::uint32_t>(face_.size());
        face_.push_back(f);
    }
    normal_.resize(face_.size());
    posture_.resize(face_.size());
}

// Postures of the faces of pulled vertices.
void FlipGuard::measure(const Flags& pulled)
{
    const TriangleMesh& mesh = mesh_.mesh;
    parallel_for(
        face_.size(),
        [&](std::size_t i) {
            const FaceId f = face_[i];
            if (!touched(f, pulled)) return;
            normal_[i] = face_normal(mesh, f);
            double longest = 0.0; // squared
            for (int k = 0; k < 3; ++k)
                longest = std::max(longest, (corner(mesh, f, (k + 1) % 3) - corner(mesh, f, k)).squaredNorm());
            const bool flat = normal_[i].isZero();
            posture_[i].shape = flat ? 0.0f : static_cast<float>(area_vector(mesh, f).norm() / longest);
            posture_[i].facing =
                flat ? -1.0f : static_cast<float>(normal_[i].dot(mesh_.plane[mesh_.face_plane[f]].normal));
        },
        kFlipGrain);
    parallel_for(
        face_.size(),
        [&](std::size_t i) {
            if (touched(face_[i], pulled)) measure_edges(static_cast<std::uint32_t>(i));
        },
        kFlipGrain);
}

void FlipGuard::measure_edges(std::uint32_t slot)
{
    for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t o = opposite_[3 * face_[slot] + k];
        if (!is_half_edge(o)) continue;
        posture_[slot].unfold[k] = std::max(-1.0f, static_cast<float>(normal_[slot].dot(normal(o / 3))));
    }
}

// Moved vertices, to be pulled back farther, of faces of pulled vertices that do not keep to the limits.
Flags FlipGuard::guilty(const Flags& pulled) const
{
    Flags guilty(before_.size(), 0);
    const auto accuse = [&](FaceId f) {
        for (const VertexId v : mesh_.mesh.face[f])
            guilty[v] = moved_[v] != 0 && halved_[v] <= halvings_ ? 1 : 0;
    };
    for (std::size_t i = 0; i < face_.size(); ++i) {
        const FaceId f = face_[i];
        if (!touched(f, pulled)) continue;
        const Posture &now = posture_[i], &least = least_[i];
        if (now.facing < least.facing || now.shape < least.shape) accuse(f);
        for (std::size_t k = 0; k < 3; ++k) {
            if (now.unfold[k] >= least.unfold[k]) continue;
            accuse(f);
            accuse(opposite_[3 * f + k] / 3);
        }
    }
    return guilty;
}

// Was there a vertex to pull?
bool FlipGuard::pull_back(const Flags& guilty)
{
    bool found = false;
    for (VertexId v = 0; v < before_.size(); ++v) {
        if (guilty[v] == 0) continue;
        found = true;
        ++halved_[v];
        const float part = halved_[v] > halvings_ ? 0.0f : 1.0f / static_cast<float>(1 << halved_[v]);
        mesh_.mesh.position[v] = before_[v] + part * (wanted_[v] - before_[v]);
    }
    return found;
}

} // namespace

std::size_t hold_back_flips(PlaneMesh& mesh, const Positions& before, const FlipLimits& limits, int halvings)
{
    return FlipGuard(mesh, before, limits, halvings).run();
}

} // namespace quoin
