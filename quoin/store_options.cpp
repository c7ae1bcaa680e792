#include "quoin/store_options.h"

#include "base/error.h"

#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>

namespace quoin {
namespace fs = std::filesystem;

void StoreOptions::add_to(CLI::App& app)
{
    app.add_option("--store", store, "the store (default: $QUOIN_STORE, or OUT/.store)");
    app.add_option("--out", out, "the --out of `quoin run`")->capture_default_str();
}

Store StoreOptions::open() const
{
    const char* variable = std::getenv("QUOIN_STORE");
    fs::path root = !store.empty() ? fs::path(store) : variable ? fs::path(variable) : fs::path(out) / ".store";
    if (!fs::is_directory(root / "v1"))
        throw InputError(fmt::format("{}: there is no store; name one with --store or $QUOIN_STORE", root.string()));
    return Store(std::move(root));
}

} // namespace quoin
