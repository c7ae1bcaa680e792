// The faces of every cluster in one array.
#pragma once

#include "geometry/plane.h"
#include "mesh/triangle_mesh.h"

#include <span>
#include <vector>

namespace quoin {

struct GroupedFaces {
    std::vector<std::uint32_t> first; // clusters + 1
    std::vector<FaceId> face;         // ascending in every cluster
    std::span<const FaceId> of(std::size_t cluster) const
    {
        return {face.data() + first[cluster], first[cluster + 1] - first[cluster]};
    }
};

// face_cluster: F ids below `clusters`, or kNoPlane for faces to leave out.
GroupedFaces group_faces(const std::vector<std::uint32_t>& face_cluster, std::size_t clusters);

} // namespace quoin
