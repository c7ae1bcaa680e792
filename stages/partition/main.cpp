#include "partition/partition.h"

#include "schema/schema.h"
#include "stage/stage.h"

int main(int argc, char** argv)
{
    using namespace quoin;
    const Stage stage{
        .name = "partition",
        .summary = "divides the faces of a dense mesh into near-planar clusters and fits a plane to each",
        .impl_version = 5,
        .inputs =
            {{"mesh",
              "the dense mesh; degenerate and duplicate faces may be there, positions that are not finite may not"}},
        .outputs = {{"plane_mesh", "the same faces, each with its cluster"}},
        .resources = {.memory = "bytes(mesh) * 16 + 200M"},
    };
    return run_stage<PartitionParams>(stage, argc, argv, [](const StageRun& run, const PartitionParams& params) {
        run.write("plane_mesh", partition(read_mesh(run.in("mesh")), params));
    });
}
