#pragma once

#include "store/store.h"

namespace quoin {

// Two runs of one key: does nothing when their payloads are equal. Otherwise keeps both under clash/<key>/ and throws
// ImpossibleError that names the first tensor (or file) in which they differ.
void refuse_clash(const Store& store, const Key& key, const StoreEntry& ours, const StoreEntry& theirs);

} // namespace quoin
