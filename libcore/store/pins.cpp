#include "store/pins.h"

#include "base/atomic_file.h"
#include "base/error.h"

#include <filesystem>
#include <sstream>

namespace quoin {
namespace fs = std::filesystem;
namespace {

fs::path place(const Store& store, const std::string& name)
{
    if (name.empty() || name.starts_with('.') || name.find('/') != std::string::npos)
        throw UsageError("'" + name + "' cannot name a pin; take letters, digits and dashes");
    return store.root() / "roots" / name;
}

} // namespace

void pin(const Store& store, const std::string& name, const std::set<std::string>& keys_and_payloads)
{
    std::string text;
    for (const auto& line : keys_and_payloads)
        text += line + "\n";
    write_atomically(place(store, name), text);
}

bool unpin(const Store& store, const std::string& name) { return fs::remove(place(store, name)); }

std::map<std::string, std::set<std::string>> pins(const Store& store)
{
    std::map<std::string, std::set<std::string>> pins;
    std::error_code missing;
    for (const auto& entry : fs::directory_iterator(store.root() / "roots", missing)) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with('.')) continue; // being written
        std::istringstream lines(read_text(entry.path()));
        for (std::string line; std::getline(lines, line);)
            pins[name].insert(line);
    }
    return pins;
}

} // namespace quoin
