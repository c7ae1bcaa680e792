#pragma once

#include "bake/painted_scan.h"
#include "metrics/evaluate.h"

namespace quoin::test {

// What evaluate says of a model of a painted scan, whose images are given.
inline Metrics figures_of(const PaintedScan& scan, const ScanImages& images, const TexturedMesh& textured,
                          const EvaluateParams& params)
{
    Evaluated inputs;
    inputs.scan = &images.scan();
    inputs.images = &images;
    inputs.keyframes = &scan.keyframes();
    inputs.alignment = &scan.alignment();
    inputs.textured = &textured;
    return evaluate(inputs, params);
}

} // namespace quoin::test
