#include "store/verify.h"

#include "base/parallel.h"
#include "pipeline/locate.h"
#include "pipeline/rerun.h"
#include "pipeline/text_figures.h"
#include "quoin/option_parser.h"
#include "quoin/store_options.h"

#include <algorithm>
#include <fmt/format.h>
#include <thread>

namespace quoin {
namespace {

struct VerifyOptions {
    StoreOptions store;
    bool keep = false;
    bool rerun = false;
    std::vector<int> threads;
    std::vector<std::string> stages;
    std::vector<std::string> scans;

    void add_to(OptionParser& parser)
    {
        store.add_to(parser);
        parser.flag("--keep", keep,
                    "leave damaged results in the store; by default they are taken out, to be computed again");
        parser.flag("--rerun", rerun, "also compute every result again and compare the bytes");
        parser.option("--threads", threads, "thread counts to rerun with (default: 1 and all)").comma_separated();
        parser.repeated("--stage", stages, "rerun this stage only; may be repeated");
        parser.repeated("--scan", scans, "a scan folder that results were made from: reruns read it");
    }
};

// True when nothing is damaged.
bool verify(const Store& store, const VerifyOptions& options)
{
    const bool take_out = !options.keep && store.is_writable();
    const VerifyReport report = verify_store(store, take_out);
    for (const auto& [what, found] : report.damage)
        fmt::print("{}: {}{}\n", what, found,
                   take_out ? "; taken out of the store, the next run computes it again" : "");
    fmt::print("{} and {} ({}) read, {} damaged\n", count_text(report.entries, "key"),
               count_text(report.objects, "object"), bytes_text(report.size), report.damage.size());
    return report.damage.empty();
}

// True when every rerun gave the bytes that the store has.
bool rerun(const Store& store, const VerifyOptions& options)
{
    constexpr const char* outcomes[] = {"same bytes", "DIFFERS", "FAILED", "skipped"};
    Catalogue catalogue(stage_folder());
    Rerunner rerunner(store, catalogue, {options.scans.begin(), options.scans.end()});
    auto counts = options.threads;
    if (counts.empty()) counts = {1, std::max(2, static_cast<int>(std::thread::hardware_concurrency()))};
    bool is_same = true;
    for (const auto& item : inventory_entries(store)) {
        const bool is_chosen =
            options.stages.empty() || std::ranges::find(options.stages, item.stage) != options.stages.end();
        if (item.is_damaged || !is_chosen) continue;
        for (const int threads : counts) {
            const RerunResult result = rerunner.rerun(item, threads);
            const bool is_skipped = result.outcome == RerunOutcome::Skipped;
            fmt::print("{:<18} {:.12}  {}{}{}\n", item.stage, item.key, outcomes[static_cast<int>(result.outcome)],
                       is_skipped ? ""
                                  : fmt::format(" with {}", count_text(static_cast<std::uint64_t>(threads), "thread")),
                       result.words.empty() ? "" : ": " + result.words);
            is_same = is_same && (is_skipped || result.outcome == RerunOutcome::Same);
            if (is_skipped) break;
        }
    }
    return is_same;
}

} // namespace

int verify_verb(const Arguments& arguments)
{
    OptionParser parser("reads every result in the store and says what is damaged; exit code 1 when something is",
                        "quoin verify");
    VerifyOptions options;
    options.add_to(parser);
    if (!parser.parse(arguments)) return 0;
    const Store store = options.store.open();
    bool is_good = verify(store, options);
    if (options.rerun) is_good = rerun(store, options) && is_good;
    return is_good ? 0 : 1;
}

} // namespace quoin
