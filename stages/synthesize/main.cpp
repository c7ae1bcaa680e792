#include "stage/stage.h"
#include "synth/synthesize.h"

int main(int argc, char** argv)
{
    const quoin::Stage stage{
        .name = "synthesize",
        .summary = "invents a furnished room and scans it with the errors of a real sensor; writes the truth along",
        .inputs = {},
        .outputs = {{"folder", "a scan folder in BundleFusion's layout, with ground_truth/"}},
        .resources = {.memory = "1500M"},
    };
    return quoin::run_stage<quoin::SynthParams>(
        stage, argc, argv, [](const quoin::StageRun& run, const quoin::SynthParams& params) {
            run.write_folder("folder", [&](const std::filesystem::path& folder) { synthesize_scan(params, folder); });
        });
}
