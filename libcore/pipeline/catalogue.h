// The stage executables that there are: those beside the driver, by short name, and any other program by its path.
#pragma once

#include "pipeline/description.h"
#include "pipeline/description_cache.h"
#include "pipeline/source.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace quoin {

// Describes programs on demand and remembers the answers.
class Catalogue {
public:
    // `folder` holds the stage executables: build/release/bin, or where Quoin is installed.
    // `cache` remembers the answers of compiled programs between runs; empty = ask every time.
    explicit Catalogue(std::filesystem::path folder, const std::filesystem::path& cache = user_cache_folder());

    // Names of the executables in the folder that answer --describe under their own name, sorted.
    std::vector<std::string> names();

    // The path that `use` means: a short name, or a path (relative ones against `relative_to`). It need not exist.
    std::filesystem::path locate(const std::string& use, const std::filesystem::path& relative_to) const;

    // Asks all programs side by side, so that describe() answers at once.
    void prepare(const std::vector<std::filesystem::path>& programs);

    // Throws UsageError when there is no such program or it does not describe itself. A program that does not lie in
    // the folder is foreign.
    const Program& describe(const std::filesystem::path& program);

    // The described command line of a YAML file (command_file.h); nullptr when there are problems.
    const Program* describe_command(const std::filesystem::path& file, Problems& problems);

private:
    struct Answer {
        Program program;
        std::string error; // why the description cannot be used
    };
    void take(const std::filesystem::path& program, const std::string& description);
    bool take_known(const std::filesystem::path& program); // from the cache

    std::filesystem::path folder_;
    DescriptionCache cache_;
    std::map<std::filesystem::path, Answer> answers_;
};

// True when `use` is a path (or a YAML file) and not a short name.
bool names_a_path(const std::string& use);

} // namespace quoin
