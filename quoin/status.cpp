#include "base/error.h"
#include "pipeline/layout.h"
#include "pipeline/run_record.h"
#include "pipeline/text_figures.h"
#include "quoin/option_parser.h"
#include "quoin/submission_status.h"

#include <algorithm>
#include <fmt/format.h>

namespace quoin {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> folders_in(const fs::path& folder)
{
    std::vector<fs::path> folders;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.is_directory() && !entry.path().filename().string().starts_with('.')) folders.push_back(entry.path());
    std::ranges::sort(folders);
    return folders;
}

struct StageStatus {
    std::string stage;
    RunRecord record;
};

bool reads_from(const StageStatus& reader, const StageStatus& writer)
{
    return std::ranges::any_of(reader.record.inputs, [&](const auto& input) {
        return std::ranges::any_of(writer.record.outputs,
                                   [&](const auto& output) { return output.second == input.second; });
    });
}

// Records in the order of the data: a stage behind those whose outputs it read; ties and circles keep the order of
// names.
std::vector<StageStatus> in_order_of_data(std::vector<StageStatus> left)
{
    std::vector<StageStatus> order;
    while (!left.empty()) {
        const auto is_free = [&](const StageStatus& stage) {
            return std::ranges::none_of(
                left, [&](const StageStatus& other) { return &other != &stage && reads_from(stage, other); });
        };
        auto next = std::ranges::find_if(left, is_free);
        if (next == left.end()) next = left.begin();
        order.push_back(std::move(*next));
        left.erase(next);
    }
    return order;
}

void print_scan(const Layout& layout, const std::string& scan)
{
    std::vector<StageStatus> stages;
    for (const auto& folder : folders_in(layout.scan_folder(scan)))
        if (const auto record = read_run_record(folder / "record.json"))
            stages.push_back({folder.filename().string(), *record});
    if (stages.empty()) return;
    fmt::print("{}\n", scan);
    for (const auto& [stage, record] : in_order_of_data(std::move(stages))) {
        std::vector<std::string> outputs;
        for (const auto& [port, payload] : record.outputs)
            outputs.push_back(fmt::format("{} {:.12}", port, payload));
        fmt::print("  {:<22} {:>10} {:>9}  {}\n", stage, duration_text(record.seconds),
                   bytes_text(record.peak_memory_bytes), fmt::join(outputs, ", "));
    }
    if (const fs::path model = layout.scan_folder(scan) / "model"; fs::is_directory(model))
        fmt::print("  model: {}\n", model.string());
}

} // namespace

int status_verb(const Arguments& arguments)
{
    OptionParser parser(
        "shows what a folder of results holds, with seconds and peak memory; or how far a Slurm submission is",
        "quoin status");
    std::string out = "out";
    parser.option("OUT", out, "the --out of `quoin run`, or the folder of `quoin submit`").show_default();
    if (!parser.parse(arguments)) return 0;
    if (is_submission(out)) {
        print_submission(out);
        return 0;
    }
    const Layout layout{fs::path(out), {}};
    if (!fs::is_directory(layout.out))
        throw InputError(fmt::format("{}: no such folder; `quoin run --out {}` makes one", out, out));
    for (const auto& folder : folders_in(layout.out))
        print_scan(layout, folder.filename().string());
    return 0;
}

} // namespace quoin
