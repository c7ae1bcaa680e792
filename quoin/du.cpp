#include "base/error.h"
#include "pipeline/text_figures.h"
#include "quoin/option_parser.h"
#include "quoin/store_options.h"
#include "store/inventory.h"
#include "store/object.h"
#include "store/run_file.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <set>

namespace quoin {
namespace {

using Sizes = std::map<std::string, std::uint64_t>; // by payload

struct Usage {
    std::size_t results = 0;
    std::set<std::string> payloads; // an object counts once
};

std::uint64_t size_of(const Usage& usage, const Sizes& sizes)
{
    std::uint64_t size = 0;
    for (const auto& payload : usage.payloads)
        if (const auto object = sizes.find(payload); object != sizes.end()) size += object->second;
    return size;
}

// Largest first.
void print_table(const char* title, const std::map<std::string, Usage>& usages, const Sizes& sizes)
{
    std::vector<std::pair<std::uint64_t, std::string>> rows;
    for (const auto& [name, usage] : usages)
        rows.emplace_back(size_of(usage, sizes), name);
    std::ranges::stable_sort(rows, std::greater(), [](const auto& row) { return row.first; });
    fmt::print("{:<28} {:>8} {:>8} {:>10}\n", title, "results", "objects", "size");
    for (const auto& [size, name] : rows)
        fmt::print("{:<28} {:>8} {:>8} {:>10}\n", name, usages.at(name).results, usages.at(name).payloads.size(),
                   bytes_text(size));
}

std::map<std::string, Usage> by_stage(const std::vector<InventoryEntry>& entries)
{
    std::map<std::string, Usage> usages;
    for (const auto& item : entries) {
        Usage& usage = usages[item.is_damaged ? "(damaged)" : item.stage];
        ++usage.results;
        for (const auto& [port, payload] : item.entry.outputs)
            usage.payloads.insert(payload);
    }
    return usages;
}

// Variants are names of runs: the store itself does not know them, its logs do.
std::map<std::string, Usage> by_variant(const Store& store)
{
    std::map<std::string, std::set<std::string>> keys;
    std::map<std::string, Usage> usages;
    for (const auto& file : run_files(store))
        for (const auto& task : read_run_file(file).tasks) {
            const std::string variant = task.variant.empty() ? "(none)" : task.variant;
            if (!task.key.empty() && keys[variant].insert(task.key).second) ++usages[variant].results;
            for (const auto& [port, payload] : task.outputs)
                usages[variant].payloads.insert(payload);
        }
    return usages;
}

} // namespace

int du_verb(const Arguments& arguments)
{
    OptionParser parser("shows how much of the disk the store takes, by stage and by variant", "quoin du");
    StoreOptions options;
    options.add_to(parser);
    if (!parser.parse(arguments)) return 0;
    const Store store = options.open();
    Sizes sizes;
    std::uint64_t total = 0, linked = 0;
    for (const auto& object : inventory_objects(store)) {
        sizes[object.payload] = object.size;
        total += object.size;
        if (object.is_linked) linked += object.size;
    }
    print_table("stage", by_stage(inventory_entries(store)), sizes);
    if (const auto variants = by_variant(store); variants.size() > 1) {
        fmt::print("\n");
        print_table("variant", variants, sizes);
    }
    fmt::print("\nobjects {} in all, {} of it shared with folders of results; temporaries {}, clashes {}\n",
               bytes_text(total), bytes_text(linked), bytes_text(object_size(store.root() / "tmp").value_or(0)),
               bytes_text(object_size(store.root() / "clash").value_or(0)));
    return 0;
}

} // namespace quoin
