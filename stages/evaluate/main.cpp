#include "metrics/evaluate.h"
#include "schema/filled_schema.h"
#include "schema/schema.h"
#include "stage/stage.h"

#include <cstdio>
#include <optional>

namespace {

template <class T, class Read>
std::optional<T> read_if_given(const quoin::StageRun& run, const char* port, const Read& read)
{
    if (!run.has(port)) return std::nullopt;
    return read(run.in(port));
}

template <class T>
const T* address(const std::optional<T>& value)
{
    return value ? &*value : nullptr;
}

} // namespace

int main(int argc, char** argv)
{
    const quoin::Stage stage{
        .name = "evaluate",
        .summary = "measures a model against ground truth, dense mesh and held-out photographs",
        .impl_version = 9,
        .inputs = {{"scan", "for held-out views and poses", true},
                   {"keyframes", "for poses", true},
                   {"mesh", "dense mesh", true},
                   {"plane_mesh", "light mesh", true},
                   {"alignment", "optimised poses and exposures", true},
                   {"textured_mesh", "the finished model", true},
                   {"folder", "the scan folder, for its ground_truth/ if it has one", true}},
        .outputs = {{"metrics", "named figures"}},
        .reads_images = true,
    };
    return quoin::run_stage<quoin::EvaluateParams>(
        stage, argc, argv, [](const quoin::StageRun& run, const quoin::EvaluateParams& params) {
            using namespace quoin;
            const auto scan = read_if_given<Scan>(run, "scan", read_scan);
            const auto keyframes = read_if_given<Keyframes>(run, "keyframes", read_keyframes);
            const auto dense = read_if_given<TriangleMesh>(run, "mesh", read_mesh);
            const auto planes = read_if_given<PlaneMesh>(run, "plane_mesh", read_plane_mesh);
            const auto alignment = read_if_given<Alignment>(run, "alignment", read_alignment);
            const auto textured = read_if_given<TexturedMesh>(run, "textured_mesh", read_textured_mesh);
            const auto truth = run.has("folder") ? find_ground_truth(run.in("folder")) : std::nullopt;
            std::optional<ScanImages> images;
            if (scan && !run.scan_root().empty()) images.emplace(*scan, run.scan_root());
            const char* model = textured ? "textured_mesh" : "plane_mesh";
            const Metrics metrics =
                evaluate({address(scan), address(images), address(keyframes), address(dense), address(planes),
                          address(alignment), address(textured), address(truth),
                          run.has(model) ? read_face_filled(run.in(model)) : std::vector<std::uint8_t>()},
                         params);
            std::fputs(metrics_table(metrics).c_str(), stdout);
            run.write("metrics", metrics);
        });
}
