#include "merge/merge.h"

#include "schema/schema.h"
#include "stage/stage.h"

int main(int argc, char** argv)
{
    using namespace quoin;
    const Stage stage{
        .name = "merge",
        .summary = "joins neighbouring clusters that lie in one plane, absorbs bumps and tiny clusters, and "
                   "straightens narrow steps",
        .impl_version = 7,
        .inputs = {{"plane_mesh", "clusters of the dense mesh"}},
        .outputs = {{"plane_mesh", "the same faces in fewer planes"}},
        .resources = {.memory = "bytes(plane_mesh) * 4 + 200M"},
    };
    return run_stage<MergeParams>(stage, argc, argv, [](const StageRun& run, const MergeParams& params) {
        run.write("plane_mesh", merge_planes(read_plane_mesh(run.in("plane_mesh")), params));
    });
}
