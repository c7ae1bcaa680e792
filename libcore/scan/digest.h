#pragma once

#include "scan/scan.h"

#include <cstddef>
#include <span>

namespace quoin {

Sha256 sha256(std::span<const std::byte> bytes);

} // namespace quoin
