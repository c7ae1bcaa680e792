#include "store/clash.h"

#include "artifact/difference.h"
#include "artifact/digest.h"
#include "base/error.h"
#include "store/object.h"

#include <fmt/format.h>
#include <set>

namespace quoin {
namespace fs = std::filesystem;
namespace {

std::set<std::string> files_in(const fs::path& folder)
{
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) names.insert(entry.path().lexically_relative(folder).generic_string());
    return names;
}

std::string first_file_difference(const fs::path& ours, const fs::path& theirs)
{
    std::set<std::string> names = files_in(ours);
    names.merge(files_in(theirs));
    for (const auto& name : names) {
        if (!fs::exists(ours / name)) return fmt::format("file '{}' is missing in ours", name);
        if (!fs::exists(theirs / name)) return fmt::format("file '{}' is missing in theirs", name);
        if (sha256_hex_of_file(ours / name) != sha256_hex_of_file(theirs / name))
            return fmt::format("file '{}' differs", name);
    }
    return "no file differs";
}

std::string first_object_difference(const fs::path& ours, const fs::path& theirs)
{
    try {
        if (fs::is_directory(ours)) return first_file_difference(ours, theirs);
        return first_difference(read_artifact(ours), read_artifact(theirs)).value_or("no tensor differs");
    } catch (const Error& error) {
        return error.what();
    }
}

// Hard links: the objects may be collected, the evidence stays.
fs::path keep_both(const Store& store, const Key& key, const std::string& port,
                   const std::pair<std::string, std::string>& payloads)
{
    fs::path folder = store.root() / "clash" / key.hex;
    for (const auto& payload : {payloads.first, payloads.second}) {
        const fs::path object = store.object(payload);
        const char* extension = fs::is_directory(object) ? "" : ".safetensors";
        store.link(payload, folder / fmt::format("{}-{:.12}{}", port, payload, extension));
    }
    return folder;
}

} // namespace

void refuse_clash(const Store& store, const Key& key, const StoreEntry& ours, const StoreEntry& theirs)
{
    for (const auto& [port, payload] : ours.outputs) {
        const auto other = theirs.outputs.find(port);
        if (other == theirs.outputs.end() || other->second == payload) continue;
        const fs::path folder = keep_both(store, key, port, {payload, other->second});
        throw ImpossibleError(fmt::format(
            "output '{}' differs from what another run of the same key computed: {} (ours, theirs); the "
            "stage is not deterministic; theirs stays, both are kept in {}",
            port, first_object_difference(store.object(payload), store.object(other->second)), folder.string()));
    }
}

} // namespace quoin
