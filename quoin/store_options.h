// Options of the verbs that look after a store.
#pragma once

#include "store/store.h"

#include <CLI/CLI.hpp>
#include <string>

namespace quoin {

struct StoreOptions {
    std::string store;
    std::string out = "out";

    void add_to(CLI::App& app);

    // Throws InputError when there is no store: these verbs make none.
    Store open() const;
};

} // namespace quoin
