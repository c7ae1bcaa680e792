#pragma once

#include "mesh/plane_mesh.h"

#include <vector>

namespace quoin {

struct PlanePair {
    PlaneId first = 0, second = 0;
    double angle = 0.0;  // [rad], between the normals
    double offset = 0.0; // [m], of the first plane's centre from the second plane
};

struct PlaneMatches {
    std::vector<PlanePair> pairs; // sorted by the first; every plane is in one pair at most
    std::vector<PlaneId> only_first, only_second;
    double area_only_first = 0.0, area_only_second = 0.0; // [m^2]
};

// Planes that cover the same surface: of all pairs whose samples lie near each other and face the same way, those that
// share most of the area come first. Planes without area are left out.
PlaneMatches match_planes(const PlaneMesh& first, const PlaneMesh& second);

} // namespace quoin
