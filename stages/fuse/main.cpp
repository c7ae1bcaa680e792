#include "fusion/fuse.h"

#include "schema/schema.h"
#include "stage/stage.h"

int main(int argc, char** argv)
{
    using namespace quoin;
    const Stage stage{
        .name = "fuse",
        .summary =
            "fuses the depth images of a scan into one dense coloured mesh, or cleans up the mesh that the scan brings",
        .impl_version = 2,
        .inputs = {{"scan", "the table of frames"}},
        .outputs = {{"mesh", "dense triangles, counter-clockwise seen from the cameras' side"}},
        .reads_images = true,
        .resources = {.memory = "5G"},
    };
    return run_stage<FuseParams>(stage, argc, argv, [](const StageRun& run, const FuseParams& params) {
        const Scan scan = read_scan(run.in("scan"));
        run.write("mesh", fuse(ScanImages(scan, run.scan_root()), params));
    });
}
