#include "pipeline/locate.h"

#include "base/error.h"
#include "pipeline/process.h"
#include "pipeline/source.h"

#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>
#include <sstream>
#include <unistd.h>
#include <vector>

namespace quoin {
namespace fs = std::filesystem;
namespace {

fs::path folder_of(const std::string& kind)
{
    std::string variable = "QUOIN_" + kind;
    std::ranges::transform(variable, variable.begin(),
                           [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    if (const char* folder = std::getenv(variable.c_str()); folder && *folder) return folder;
    const fs::path bin = executable_path().parent_path();
    if (fs::path shared = bin.parent_path() / "share" / "quoin" / kind; fs::is_directory(shared)) return shared;
    constexpr int kLevels = 3; // build/release/bin lies three folders below the source tree
    fs::path ancestor = bin;
    for (int level = 0; level < kLevels; ++level) {
        ancestor = ancestor.parent_path();
        if (fs::is_directory(ancestor / kind)) return ancestor / kind;
    }
    throw UsageError(fmt::format("there is no folder '{}' near {}; set ${} to it", kind, bin.string(), variable));
}

std::vector<std::string> yaml_names(const fs::path& folder)
{
    std::vector<std::string> names;
    if (!fs::is_directory(folder)) return names;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
    std::ranges::sort(names);
    return names;
}

} // namespace

fs::path stage_folder()
{
    if (const char* folder = std::getenv("QUOIN_STAGES"); folder && *folder)
        return fs::absolute(folder).lexically_normal();
    const fs::path bin = executable_path().parent_path();
    const fs::path installed = bin.parent_path() / "libexec" / "quoin";
    return fs::is_directory(installed) ? installed : bin;
}

fs::path command_runner()
{
    constexpr const char* kName = "run-command";
    const fs::path beside_stages = stage_folder() / kName;
    return fs::exists(beside_stages) ? beside_stages : executable_path().parent_path() / kName;
}

fs::path find_in_path(const std::string& name)
{
    const char* variable = std::getenv("PATH");
    std::istringstream folders(variable ? variable : "");
    for (std::string folder; std::getline(folders, folder, ':');)
        if (fs::path file = fs::path(folder) / name; fs::is_regular_file(file) && ::access(file.c_str(), X_OK) == 0)
            return file;
    return {};
}

fs::path find_yaml(const std::string& kind, const std::string& name)
{
    if (fs::is_regular_file(name)) return name;
    const bool is_path = name.find('/') != std::string::npos || name.ends_with(".yaml") || name.ends_with(".yml");
    if (is_path) throw UsageError(fmt::format("{}: no such file", name));
    const fs::path folder = folder_of(kind);
    if (fs::path file = folder / (name + ".yaml"); fs::is_regular_file(file)) return file;
    throw UsageError(fmt::format("there is no '{}' in {}{}", name, folder.string(), hint(name, yaml_names(folder))));
}

} // namespace quoin
