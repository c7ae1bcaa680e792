// Variants of a pipeline, to be run over the same scans and compared with the first of them, the baseline.
//
//     variants:                                    # by name; each is laid over the pipeline
//       no-lines: {remove: [detect-lines]}
//       paper:    {config: paper}                  # parameter sets
//       mine:     {simplify: {use: ./my-simplify, params: {ratio: 0.1}}, merge.max_angle: 5}
//     matrix:                                      # every combination
//       simplify.max_error: [0.002, 0.004]
//       partition.method: [heap, hybrid]
//       exclude: [{simplify.max_error: 0.002, partition.method: heap}]
//       include: [{simplify.max_error: 0.1}]
//     ablate:                                      # one change at a time around the baseline
//       baseline: {bake-texture.blend: mean}
//       one_at_a_time: {simplify.max_error: [0.001, 0.01], merge.use: [./mine], variant: [no-lines]}
//     report: {metrics: [geometry.*, views.model.psnr]}
//
// Without `one_at_a_time: {variant: ...}` every variant takes part.
#pragma once

#include "pipeline/pipeline.h"

#include <string>
#include <vector>

namespace quoin {

struct Variant {
    std::string name; // a folder of the output; "baseline", "no-lines", "simplify.max_error=0.001"
    Pipeline pipeline;
};

struct Study {
    std::vector<Variant> variants;    // names are unique
    std::vector<std::string> metrics; // patterns of those to show, in this order; empty = all
};

// What the command line adds to the file.
struct StudyArguments {
    std::vector<std::string> vary;   // "stage.param=1,2,3": one at a time
    std::vector<std::string> matrix; // the same: every combination
    std::vector<std::string> only;   // names of variants; empty = all
};

// What is wrong is added to `problems`.
Study make_study(const Pipeline& pipeline, const StudyArguments& arguments, Problems& problems);

// The pipeline with the one variant of `variants:` laid over it.
Pipeline make_variant(const Pipeline& pipeline, const std::string& name, Problems& problems);

} // namespace quoin
