#include "mesh/flip_guard.h"

#include "base/parallel.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace quoin {
namespace {

constexpr std::size_t kGrain = 1 << 13;

// Cosine between a face and its plane; -1 for a face without area.
std::vector<float> plane_cosines(const PlaneMesh& mesh)
{
    std::vector<float> cosine(mesh.mesh.face.size());
    parallel_for(
        cosine.size(),
        [&](std::size_t f) {
            const Eigen::Vector3d normal = face_normal(mesh.mesh, static_cast<FaceId>(f));
            cosine[f] = normal.isZero() ? -1.0f : static_cast<float>(normal.dot(mesh.plane[mesh.face_plane[f]].normal));
        },
        kGrain);
    return cosine;
}

} // namespace

std::size_t hold_back_flips(PlaneMesh& mesh, const std::vector<Eigen::Vector3f>& before, double min_cosine,
                            int halvings)
{
    const auto wanted = mesh.mesh.position;
    mesh.mesh.position = before;
    auto lowest = plane_cosines(mesh);
    for (auto& cosine : lowest)
        cosine = std::min(cosine, static_cast<float>(min_cosine));
    mesh.mesh.position = wanted;

    std::vector<std::uint8_t> halved(before.size(), 0); // times; more than `halvings` is all the way back
    for (bool found = true; found;) {
        found = false;
        const auto cosine = plane_cosines(mesh);
        std::vector<std::uint8_t> guilty(before.size(), 0);
        for (FaceId f = 0; f < cosine.size(); ++f) {
            if (cosine[f] >= lowest[f]) continue;
            for (const VertexId v : mesh.mesh.face[f])
                guilty[v] = halved[v] <= halvings ? 1 : 0;
        }
        for (VertexId v = 0; v < before.size(); ++v) {
            if (guilty[v] == 0) continue;
            found = true;
            ++halved[v];
            const float part = halved[v] > halvings ? 0.0f : 1.0f / static_cast<float>(1 << halved[v]);
            mesh.mesh.position[v] = before[v] + part * (wanted[v] - before[v]);
        }
    }
    return static_cast<std::size_t>(std::count_if(halved.begin(), halved.end(), [](auto times) { return times > 0; }));
}

} // namespace quoin
