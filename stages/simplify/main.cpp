#include "schema/schema.h"
#include "simplify/simplify.h"
#include "stage/stage.h"

int main(int argc, char** argv)
{
    using namespace quoin;
    const Stage stage{
        .name = "simplify",
        .summary = "decimates every plane, then the borders between planes, which stay straight and where they are",
        .impl_version = 10,
        .inputs = {{"plane_mesh", "planes of a dense mesh"}},
        .outputs = {{"plane_mesh", "the same planes in few faces"}},
        .resources = {.memory = "bytes(plane_mesh) * 12 + 200M"},
    };
    return run_stage<SimplifyParams>(stage, argc, argv, [](const StageRun& run, const SimplifyParams& params) {
        run.write("plane_mesh", simplify(read_plane_mesh(run.in("plane_mesh")), params));
    });
}
