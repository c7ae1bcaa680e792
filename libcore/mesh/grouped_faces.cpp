#include "mesh/grouped_faces.h"

namespace quoin {

GroupedFaces group_faces(const std::vector<std::uint32_t>& face_cluster, std::size_t clusters)
{
    GroupedFaces groups{std::vector<std::uint32_t>(clusters + 1, 0), {}};
    for (const std::uint32_t cluster : face_cluster)
        if (cluster != kNoPlane) ++groups.first[cluster + 1];
    for (std::size_t c = 0; c < clusters; ++c)
        groups.first[c + 1] += groups.first[c];
    groups.face.resize(groups.first.back());
    std::vector<std::uint32_t> next(groups.first.begin(), groups.first.end() - 1);
    for (FaceId f = 0; f < face_cluster.size(); ++f)
        if (face_cluster[f] != kNoPlane) groups.face[next[face_cluster[f]]++] = f;
    return groups;
}

} // namespace quoin
