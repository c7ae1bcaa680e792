// Figures as a person reads them.
#pragma once

#include <cstdint>
#include <string>

namespace quoin {

std::string duration_text(double seconds);                             // "0.21 s", "12.3 s", "3:07 min", "1:02:07 h"
std::string bytes_text(std::uint64_t bytes);                           // "512 B", "1.4 MB", "2.0 GB" (powers of 1000)
std::string rate_text(double items_per_second);                        // "12.3/s", "1250/s"
std::string count_text(std::uint64_t count, const std::string& thing); // "1 stage", "13 stages"

// "4G", "512M", "1.5G", "800000" to bytes (powers of 1024); throws UsageError naming the flag.
std::uint64_t parse_bytes(const std::string& text, const std::string& flag);

// "90s", "30m", "2h", "1.5" (seconds) to seconds; throws UsageError naming the flag.
double parse_duration(const std::string& text, const std::string& flag);

} // namespace quoin
