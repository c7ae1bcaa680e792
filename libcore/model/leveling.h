// Which way is up, where the floor is and how the walls run.
#pragma once

#include "model/export_model.h"

#include <optional>

namespace quoin {

struct Leveling {
    Rigid model_from_world = Rigid::Identity();
    std::optional<PlaneId> floor;
};

// Up is the mean up direction of the cameras, snapped to the planes nearly perpendicular to it; the floor is the lowest
// large plane that faces up, at height 0; the model's x and z axes are parallel to most walls and its centre is on the
// vertical axis. Without planes, up is the cameras' and the lowest vertex is at height 0.
Leveling find_level(const TriangleMesh& mesh, const PlaneMesh* planes, const std::vector<Rigid>& camera_from_world,
                    const ExportParams& params);

} // namespace quoin
