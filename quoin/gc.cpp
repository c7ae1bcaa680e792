#include "store/gc.h"

#include "base/error.h"
#include "pipeline/text_figures.h"
#include "quoin/option_parser.h"
#include "quoin/store_options.h"

#include <charconv>
#include <fmt/format.h>

namespace quoin {
namespace {

// "14d", "36h", "90m", "2w" in seconds.
double parse_age(const std::string& text)
{
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const std::string unit(end, text.data() + text.size());
    constexpr std::pair<const char*, double> units[] = {
        {"s", 1.0}, {"m", 60.0}, {"h", 3600.0}, {"d", 86'400.0}, {"w", 604'800.0}};
    for (const auto& [name, seconds] : units)
        if (error == std::errc() && value >= 0.0 && unit == name) return value * seconds;
    throw UsageError(fmt::format("--older-than is '{}': expected an age such as 14d, 36h or 2w", text));
}

void print_report(const GcReport& report, bool is_dry)
{
    for (const auto& item : report.kept)
        if (is_dry) fmt::print("keep    {:<28} {:>9}  {}\n", item.what, bytes_text(item.size), item.why);
    for (const auto& item : report.removed)
        fmt::print("{}  {:<28} {:>9}  {}\n", is_dry ? "would go" : "removed ", item.what, bytes_text(item.size),
                   item.why);
    fmt::print("objects: {} before, {} {}\n", bytes_text(report.size_before), bytes_text(report.size_after),
               is_dry ? "after it" : "now");
}

} // namespace

int gc_verb(const Arguments& arguments)
{
    OptionParser parser(
        "frees space in the store; results that pins, the last runs, running processes or folders of results "
        "hold stay. Without a limit only rubbish goes",
        "quoin gc");
    StoreOptions store;
    GcOptions options;
    std::string max_size, older_than;
    store.add_to(parser);
    parser.option("--max-size", max_size, "what was unused for longest goes until the store fits, like 200G");
    parser.option("--older-than", older_than, "what was unused for longer goes, like 14d");
    parser.option("--keep-last", options.keep_last, "runs whose results stay (default: 3); alone: all else goes")
        .not_negative();
    parser.flag("--dry-run", options.is_dry, "only say what would go and what stays, each with the reason");
    if (!parser.parse(arguments)) return 0;
    if (!max_size.empty()) options.max_size = parse_bytes(max_size, "--max-size");
    if (!older_than.empty()) options.older_than = parse_age(older_than);
    print_report(collect_garbage(store.open(), options), options.is_dry);
    return 0;
}

} // namespace quoin
