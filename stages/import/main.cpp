#include "scan/import.h"
#include "schema/schema.h"
#include "stage/stage.h"

int main(int argc, char** argv)
{
    using namespace quoin;
    const Stage stage{
        .name = "import",
        .summary = "finds the layout of a scan folder, checks it and makes a canonical table of frames",
        .impl_version = 2,
        .inputs = {{"folder", "a scan in any known layout"}},
        .outputs = {{"scan", "frames with poses, cameras and the digest of every file"}},
    };
    return run_stage<ImportParams>(stage, argc, argv, [](const StageRun& run, const ImportParams& params) {
        const ImportedScan imported = import_scan(run.in("folder"), params);
        log_report(imported.report);
        run.write("scan", imported.scan);
    });
}
