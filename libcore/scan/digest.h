#pragma once

#include "scan/scan.h"

#include <cstddef>
#include <span>
#include <string>

namespace quoin {

Sha256 sha256(std::span<const std::byte> bytes);
std::string to_hex(const Sha256& digest); // 64 lower-case digits

} // namespace quoin
