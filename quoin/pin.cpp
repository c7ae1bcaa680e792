#include "store/pins.h"

#include "artifact/artifact.h"
#include "base/error.h"
#include "quoin/option_parser.h"
#include "quoin/store_options.h"
#include "store/run_file.h"

#include <filesystem>
#include <fmt/format.h>

namespace quoin {
namespace {

namespace fs = std::filesystem;

// What an argument names: an artifact file, a run, or a key or payload in full.
std::set<std::string> names_of(const Store& store, const std::string& what)
{
    if (fs::is_regular_file(what)) return {read_artifact_header(what).payload};
    const fs::path run = store.root() / "runs" / (what + ".jsonl");
    if (fs::is_regular_file(run)) return names_in(read_run_file(run));
    if (fs::exists(store.entry(what)) || fs::exists(store.object(what))) return {what};
    throw UsageError(fmt::format("{}: no artifact, no run of `quoin log`, and no key or payload of this store", what));
}

} // namespace

int pin_verb(const Arguments& arguments)
{
    OptionParser parser("keeps results from `quoin gc`; without arguments lists what is pinned", "quoin pin");
    StoreOptions options;
    std::string name;
    std::vector<std::string> what;
    bool is_removed = false;
    options.add_to(parser);
    parser.option("NAME", name, "of the pin");
    parser.option("WHAT", what, "artifact files, runs, keys or payloads");
    parser.flag("--remove", is_removed, "remove the pin of that name");
    if (!parser.parse(arguments)) return 0;
    const Store store = options.open();
    if (name.empty()) {
        for (const auto& [pinned, held] : pins(store))
            fmt::print("{:<24} {} results\n", pinned, held.size());
        return 0;
    }
    if (is_removed) {
        if (!unpin(store, name)) throw UsageError(fmt::format("there is no pin '{}'", name));
        return 0;
    }
    if (what.empty()) throw UsageError("nothing to pin: name an artifact, a run, a key or a payload");
    std::set<std::string> names;
    for (const auto& one : what)
        names.merge(names_of(store, one));
    pin(store, name, names);
    return 0;
}

} // namespace quoin
