#include "quoin/store_options.h"

#include "base/error.h"
#include "quoin/option_parser.h"

#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>

namespace quoin {
namespace fs = std::filesystem;

void StoreOptions::add_to(OptionParser& parser)
{
    parser.option("--store", store, "the store (default: $QUOIN_STORE, or OUT/.store)");
    parser.option("--out", out, "the --out of `quoin run`").show_default();
}

Store StoreOptions::open() const
{
    const char* variable = std::getenv("QUOIN_STORE");
    const fs::path root = !store.empty() ? fs::path(store) : variable ? fs::path(variable) : fs::path(out) / ".store";
    if (!fs::is_directory(root / "v1"))
        throw InputError(fmt::format("{}: there is no store; name one with --store or $QUOIN_STORE", root.string()));
    return Store(root);
}

} // namespace quoin
