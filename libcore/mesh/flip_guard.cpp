#include "mesh/flip_guard.h"

#include "base/parallel.h"
#include "mesh/adjacency.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace quoin {
namespace {

constexpr std::size_t kFlipGrain = 1 << 13;

using Positions = std::vector<Eigen::Vector3f>;
using Flags = std::vector<std::uint8_t>;

// How faces and the edges between them lie; the larger, the better.
struct Postures {
    std::vector<float> facing; // F; cosine between a face and its plane, -1 for a face without area
    std::vector<float> shape;  // F; height over longest edge
    std::vector<float> unfold; // H; cosine between the faces on the edge of a half-edge, 1 where there are not two
};

// What must hold from now on. Faces folded already may fold further: else they would hold back all around them.
Postures least(Postures before, const FlipLimits& limits)
{
    constexpr float kOfSliver = 0.5f; // part of its shape that a sliver keeps
    for (auto& facing : before.facing)
        facing = std::min(facing, static_cast<float>(limits.min_cosine));
    for (auto& shape : before.shape)
        shape = std::min(kOfSliver * shape, static_cast<float>(limits.min_shape));
    for (auto& unfold : before.unfold)
        unfold = unfold < static_cast<float>(limits.folded_cosine) ? -1.0f : static_cast<float>(limits.folded_cosine);
    return before;
}

class FlipGuard {
public:
    FlipGuard(PlaneMesh& mesh, const Positions& before, const FlipLimits& limits, int halvings)
        : mesh_(mesh), before_(before), wanted_(mesh.mesh.position), halvings_(halvings),
          opposite_(opposite_half_edges(mesh.mesh)), halved_(before.size(), 0)
    {
        mesh_.mesh.position = before_;
        least_ = least(postures(), limits);
        mesh_.mesh.position = wanted_;
    }

    std::size_t run()
    {
        while (pull_back(guilty()))
            ;
        return static_cast<std::size_t>(
            std::count_if(halved_.begin(), halved_.end(), [](auto times) { return times > 0; }));
    }

private:
    Postures postures() const;
    Flags guilty() const;
    bool pull_back(const Flags& guilty);

    PlaneMesh& mesh_;
    const Positions& before_;
    const Positions wanted_;
    const int halvings_;
    const std::vector<std::uint32_t> opposite_;
    Flags halved_; // times, one a vertex; more than halvings_ is all the way back
    Postures least_;
};

Postures FlipGuard::postures() const
{
    const TriangleMesh& mesh = mesh_.mesh;
    const std::size_t faces = mesh.face.size();
    Postures now{std::vector<float>(faces), std::vector<float>(faces), std::vector<float>(3 * faces, 1.0f)};
    std::vector<Eigen::Vector3d> normal(faces);
    parallel_for(
        faces,
        [&](std::size_t i) {
            const auto f = static_cast<FaceId>(i);
            normal[f] = face_normal(mesh, f);
            double longest = 0.0; // squared
            for (int k = 0; k < 3; ++k)
                longest = std::max(longest, (corner(mesh, f, (k + 1) % 3) - corner(mesh, f, k)).squaredNorm());
            const bool flat = normal[f].isZero();
            now.shape[f] = flat ? 0.0f : static_cast<float>(area_vector(mesh, f).norm() / longest);
            now.facing[f] = flat ? -1.0f : static_cast<float>(normal[f].dot(mesh_.plane[mesh_.face_plane[f]].normal));
        },
        kFlipGrain);
    parallel_for(
        opposite_.size(),
        [&](std::size_t h) {
            const std::uint32_t o = opposite_[h];
            if (!is_half_edge(o)) return;
            now.unfold[h] = std::max(-1.0f, static_cast<float>(normal[h / 3].dot(normal[o / 3])));
        },
        kFlipGrain);
    return now;
}

// Vertices of faces and edges that do not keep to the limits and may still be pulled back.
Flags FlipGuard::guilty() const
{
    const Postures now = postures();
    Flags guilty(before_.size(), 0);
    const auto accuse = [&](FaceId f) {
        for (const VertexId v : mesh_.mesh.face[f])
            guilty[v] = halved_[v] <= halvings_ ? 1 : 0;
    };
    for (FaceId f = 0; f < now.facing.size(); ++f)
        if (now.facing[f] < least_.facing[f] || now.shape[f] < least_.shape[f]) accuse(f);
    for (std::uint32_t h = 0; h < opposite_.size(); ++h) {
        if (now.unfold[h] >= least_.unfold[h]) continue;
        accuse(h / 3);
        accuse(opposite_[h] / 3);
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
