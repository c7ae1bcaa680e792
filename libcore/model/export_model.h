// The finished model as files that other programs open.
#pragma once

#include "base/param.h"
#include "mesh/plane_mesh.h"
#include "mesh/textured_mesh.h"
#include "scan/alignment.h"
#include "scan/keyframes.h"
#include "scan/scan.h"

#include <filesystem>
#include <string>
#include <tuple>

namespace quoin {

struct ExportParams {
    bool level = true;
    double max_tilt = 25.0;
    double floor_area = 0.1;
    bool align_walls = true;
    bool normals = true;
    bool glb = true;
    bool obj = true;
    bool ply = true;

    static constexpr auto list()
    {
        using P = ExportParams;
        return std::tuple{
            Param{"level", &P::level, "", "turns the floor level and puts it at height 0; needs camera poses"},
            Param{"max_tilt", &P::max_tilt, "deg",
                  "largest angle between the cameras' mean up direction and the normal of a level plane", 1.0, 44.0},
            Param{"floor_area", &P::floor_area, "",
                  "the floor is the lowest level plane with at least this part of the largest one's area", 0.0, 1.0},
            Param{"align_walls", &P::align_walls, "",
                  "turns the model about the vertical until most walls are parallel to its axes"},
            Param{"normals", &P::normals, "",
                  "writes normals into GLB and OBJ; viewers that light the model need them"},
            Param{"glb", &P::glb, "", "writes model.glb"},
            Param{"obj", &P::obj, "", "writes model.obj and model.mtl"},
            Param{"ply", &P::ply, "", "writes model.ply"},
        };
    }
};

// What there is to export: one of the three meshes, the richest first, and, for trajectory and levelling, the poses of
// the keyframes (refined) or of all frames.
struct ModelParts {
    const TexturedMesh* textured = nullptr;
    const PlaneMesh* planes = nullptr;
    const TriangleMesh* mesh = nullptr;
    const Scan* scan = nullptr;
    const Keyframes* keyframes = nullptr;
    const Alignment* alignment = nullptr;
    std::string version = {}; // of the program, for the files' generator fields
};

// Fills an empty folder with model.glb (glTF 2.0, unlit), model.obj with model.mtl, the atlas pages model_N.jpg or
// .png, model.ply (plane ids and colours per face), planes.json, trajectory.txt (TUM order, camera to model) and
// summary.json. All files share one frame, the model frame: metres, +Y up, floor at height 0; summary.json holds
// model_from_world. Throws InputError when the parts do not belong together, ImpossibleError when there is no face to
// export.
void export_model(const ModelParts& parts, const std::filesystem::path& folder, const ExportParams& params);

} // namespace quoin
