// Computes results of the store again, from what the store knows of them alone, and compares: the promise that a key
// gives the same bytes, for any number of threads.
#pragma once

#include "pipeline/catalogue.h"
#include "store/inventory.h"
#include "store/store.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace quoin {

enum class RerunOutcome { Same, Differs, Failed, Skipped };

struct RerunResult {
    RerunOutcome outcome = RerunOutcome::Skipped;
    std::string words; // the first difference, or why it was not computed
};

class Rerunner {
public:
    // `scans` are folders whose contents entries were made from: the store knows them by digest only.
    Rerunner(const Store& store, Catalogue& catalogue, const std::vector<std::filesystem::path>& scans);

    RerunResult rerun(const InventoryEntry& entry, int threads);

private:
    struct Plan;
    std::string make_plan(const InventoryEntry& entry, Plan& plan) const;

    const Store& store_;
    Catalogue& catalogue_;
    std::map<std::string, std::filesystem::path> folders_; // payload -> scan folder
    std::map<std::string, std::string> folder_of_scan_;    // payload of a scan artifact -> payload of its folder
};

} // namespace quoin
