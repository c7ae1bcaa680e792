#pragma once

#include "mesh/plane_mesh.h"
#include "scan/alignment.h"
#include "scan/keyframes.h"
#include "scan/scan.h"

namespace quoin {

// What textures are baked from; all references outlive the baking.
struct BakeInput {
    const ScanImages& images;
    const Keyframes& keyframes;
    const PlaneMesh& planes;
    const Alignment& alignment;
};

} // namespace quoin
