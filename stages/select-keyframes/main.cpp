#include "keyframes/select_keyframes.h"
#include "schema/schema.h"
#include "stage/stage.h"

int main(int argc, char** argv)
{
    using namespace quoin;
    const Stage stage{
        .name = "select-keyframes",
        .summary = "takes the sharpest usable frame of every interval",
        .impl_version = 2,
        .inputs = {{"scan", "frames with poses"}},
        .outputs = {{"keyframes", "the frames to use, the blur of every frame, and why the others were left out"}},
        .reads_images = true,
    };
    return run_stage<KeyframeParams>(stage, argc, argv, [](const StageRun& run, const KeyframeParams& params) {
        const Scan scan = read_scan(run.in("scan"));
        run.write("keyframes", select_keyframes(ScanImages(scan, run.scan_root()), params));
    });
}
