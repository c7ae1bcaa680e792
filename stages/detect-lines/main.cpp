#include "lines/detect_lines.h"

#include "scan/keyframes.h"
#include "schema/schema.h"
#include "stage/stage.h"

int main(int argc, char** argv)
{
    using namespace quoin;
    const Stage stage{
        .name = "detect-lines",
        .summary = "finds straight segments in the keyframes and matches them to the borders between planes",
        .impl_version = 2,
        .inputs = {{"scan", "poses and cameras"},
                   {"keyframes", "the frames to look at"},
                   {"plane_mesh", "planes and the borders between them"}},
        .outputs = {{"lines", "segments with the 3D border that each one shows"}},
        .reads_images = true,
        .resources = {.memory = "bytes(plane_mesh) * 4 + 400M"},
    };
    return run_stage<DetectLinesParams>(stage, argc, argv, [](const StageRun& run, const DetectLinesParams& params) {
        const Scan scan = read_scan(run.in("scan"));
        const Keyframes keyframes = read_keyframes(run.in("keyframes"));
        const PlaneMesh mesh = read_plane_mesh(run.in("plane_mesh"));
        run.write("lines", detect_lines(ScanImages(scan, run.scan_root()), keyframes, mesh, params));
    });
}
