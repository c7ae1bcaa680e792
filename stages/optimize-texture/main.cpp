#include "alignment/optimize_texture.h"
#include "schema/schema.h"
#include "stage/stage.h"

int main(int argc, char** argv)
{
    using namespace quoin;
    const Stage stage{
        .name = "optimize-texture",
        .summary = "moves cameras, planes and exposures until every point of every plane has one colour",
        .impl_version = 12,
        .inputs = {{"scan", "frames, cameras and poses"},
                   {"keyframes", "the frames to align"},
                   {"plane_mesh", "the planes that the frames look at"},
                   {"lines", "segments matched to borders between planes", true}},
        .outputs = {{"alignment", "poses of the keyframes, planes, exposures, colour camera"}},
        .reads_images = true,
        .resources = {.memory = "keyframes * pixels * 14 + 500M"},
    };
    return run_stage<OptimizeTextureParams>(
        stage, argc, argv, [](const StageRun& run, const OptimizeTextureParams& params) {
            const Scan scan = read_scan(run.in("scan"));
            const ScanImages images(scan, run.scan_root());
            const LineMatches lines = run.has("lines") ? read_lines(run.in("lines")) : LineMatches{};
            run.write("alignment", optimize_texture(images, read_keyframes(run.in("keyframes")),
                                                    read_plane_mesh(run.in("plane_mesh")), lines, params));
        });
}
