// Names that gc keeps: ROOT/v1/roots/<name> holds the keys and payloads, one a line.
#pragma once

#include "store/store.h"

#include <map>
#include <set>
#include <string>

namespace quoin {

// Throws UsageError when `name` is no file name.
void pin(const Store& store, const std::string& name, const std::set<std::string>& keys_and_payloads);
bool unpin(const Store& store, const std::string& name); // false when there is none
std::map<std::string, std::set<std::string>> pins(const Store& store);

} // namespace quoin
