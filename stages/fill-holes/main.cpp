#include "fill/fill_holes.h"

#include "schema/filled_schema.h"
#include "schema/schema.h"
#include "stage/stage.h"

int main(int argc, char** argv)
{
    using namespace quoin;
    const Stage stage{
        .name = "fill-holes",
        .summary = "closes holes that no ray passed through, on their planes and up to where planes meet",
        .impl_version = 3,
        .inputs = {{"scan", "frames and the depth camera"},
                   {"keyframes", "the frames whose rays are asked"},
                   {"plane_mesh", "planes with holes"},
                   {"alignment", "poses of the keyframes"}},
        .outputs = {{"plane_mesh", "the same faces and, behind them, those that close holes"}},
        .reads_images = true,
        .resources = {.memory = "bytes(plane_mesh) * 30 + 200M"},
    };
    return run_stage<FillHolesParams>(stage, argc, argv, [](const StageRun& run, const FillHolesParams& params) {
        const Scan scan = read_scan(run.in("scan"));
        const ScanImages images(scan, run.scan_root());
        const Keyframes keyframes = read_keyframes(run.in("keyframes"));
        const PlaneMesh planes = read_plane_mesh(run.in("plane_mesh"));
        const Alignment alignment = read_alignment(run.in("alignment"));
        run.write("plane_mesh", fill_holes({planes, images, keyframes, alignment}, params));
    });
}
