// Robust planes of the clusters of a mesh.
#pragma once

#include "geometry/moments.h"
#include "mesh/triangle_mesh.h"

#include <vector>

namespace quoin {

struct RobustFit {
    int rounds = 5;       // reweightings; 0 = least squares over the area
    double tukey = 4.685; // cut-off, in standard deviations (1.4826 times the median distance)
};

struct FittedPlanes {
    std::vector<Plane> plane;
    std::vector<Moments> moments; // exact, of all faces alike, about the world origin
};

// The plane of every cluster: least squares over its faces' area, then reweighted with Tukey's biweight of the distance
// of each face's centroid (iteratively reweighted least squares). Normals point to the side that most area faces; a
// cluster without area gets the plane z = const through its vertices. face_plane: F ids below `planes`, or kNoPlane.
FittedPlanes fit_planes(const TriangleMesh& mesh, const std::vector<PlaneId>& face_plane, std::size_t planes,
                        const RobustFit& fit);

} // namespace quoin
