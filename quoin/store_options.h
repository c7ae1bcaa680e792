// Options of the verbs that look after a store.
#pragma once

#include "quoin/option_parser.h"
#include "store/store.h"

#include <string>

namespace quoin {

struct StoreOptions {
    std::string store;
    std::string out = "out";

    void add_to(OptionParser& parser);

    // Throws InputError when there is no store: these verbs make none.
    Store open() const;
};

} // namespace quoin
