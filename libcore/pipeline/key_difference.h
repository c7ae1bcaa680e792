// What two cache keys differ in: the answer to why a stage runs again.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace quoin {

struct KeyChange {
    enum class Kind { Param, Input, Other };
    Kind kind = Kind::Other;
    std::string name;          // of the parameter or input port; of the key's field otherwise ("impl_version")
    std::string before, after; // as a person writes them; "" = not there
};

// Canonical key JSON (store/key.h) of both. Parameters first, then fields, then inputs; none when they are equal.
// Unreadable JSON differs in everything.
std::vector<KeyChange> key_difference(const std::string& before, const std::string& after);

} // namespace quoin
