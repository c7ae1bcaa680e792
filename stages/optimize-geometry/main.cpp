#include "refine/refine.h"
#include "scan/alignment.h"
#include "schema/schema.h"
#include "stage/stage.h"

int main(int argc, char** argv)
{
    using namespace quoin;
    const Stage stage{
        .name = "optimize-geometry",
        .summary = "moves vertices onto the optimised planes, and those of creases and corners onto where planes meet",
        .impl_version = 4,
        .inputs = {{"plane_mesh", "simplified planes"}, {"alignment", "the planes as optimised, in the same order"}},
        .outputs = {{"plane_mesh", "the same faces on the optimised planes"}},
        .resources = {.memory = "bytes(plane_mesh) * 100 + 200M"},
    };
    return run_stage<OptimizeGeometryParams>(
        stage, argc, argv, [](const StageRun& run, const OptimizeGeometryParams& params) {
            const PlaneMesh mesh = read_plane_mesh(run.in("plane_mesh"));
            const Alignment alignment = read_alignment(run.in("alignment"));
            run.write("plane_mesh", optimize_geometry(mesh, alignment.plane, params));
        });
}
