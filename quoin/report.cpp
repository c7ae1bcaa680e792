#include "base/error.h"
#include "quoin/option_parser.h"
#include "quoin/options.h"
#include "quoin/report_sources.h"

#include <fmt/format.h>

namespace quoin {
namespace {

namespace fs = std::filesystem;

// `--out` names the folder of results, as for the other verbs, or the page to write.
fs::path take_page(PlaceOptions& place, const std::string& results, std::size_t scans)
{
    if (!place.out.ends_with(".html")) return {};
    if (scans > 1) throw UsageError(fmt::format("--out {}: one page shows one scan; give one --scan", place.out));
    fs::path page = fs::absolute(place.out).lexically_normal();
    place.out = results;
    return page;
}

} // namespace

int report_verb(const Arguments& arguments)
{
    OptionParser parser("writes a page that shows a model and its figures; it opens without network", "quoin report");
    PipelineOptions pipeline;
    PlaceOptions place;
    std::string results = "out";
    pipeline.add_to(parser);
    pipeline.add_variant_to(parser);
    place.add_to(parser);
    parser.describe("--out", "the --out of `quoin run`, or the FILE.html to write");
    parser.option("--results", results, "the --out of `quoin run`, when --out names the page").show_default();
    if (!parser.parse(arguments)) return 0;
    const Graph graph = pipeline.load();
    const auto scans = place.named_scans(graph);
    const fs::path named_page = take_page(place, results, scans.size());
    const Layout layout = place.layout();
    for (const auto& scan : scans) {
        if (!fs::is_directory(layout.scan_folder(scan.name)))
            throw InputError(fmt::format("{}: no results; `quoin run --scan {} --out {}` makes them",
                                         layout.scan_folder(scan.name).string(), scan.folder.string(), place.out));
        const fs::path page = named_page.empty() ? report_page(layout, scan.name) : named_page;
        write_report(graph, scan, layout, page);
        fmt::print("{}\n", page.lexically_proximate(fs::current_path()).string());
    }
    return 0;
}

} // namespace quoin
