#include "scan/correct_poses.h"
#include "schema/schema.h"
#include "stage/stage.h"

int main(int argc, char** argv)
{
    using namespace quoin;
    const Stage stage{
        .name = "correct-poses",
        .summary = "carries the poses and the colour camera that optimize-texture found over to all frames of the scan",
        .impl_version = 1,
        .inputs = {{"scan", "frames with their recorded poses"},
                   {"keyframes", "the frames that were aligned"},
                   {"alignment", "their poses"}},
        .outputs = {{"scan", "the same frames with corrected poses"}},
    };
    return run_stage(stage, {}, argc, argv, [](const StageRun& run, const ParamValues&) {
        const Keyframes keyframes = read_keyframes(run.in("keyframes"));
        const Alignment alignment = read_alignment(run.in("alignment"));
        run.write("scan", corrected_scan(read_scan(run.in("scan")), keyframes, alignment));
    });
}
