#include "pipeline/text_figures.h"

#include "base/error.h"

#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace quoin {

std::string duration_text(double seconds)
{
    constexpr int kMinute = 60;
    constexpr int kHour = 3600;
    if (seconds < 10.0) return fmt::format("{:.2f} s", seconds);
    if (seconds < kMinute) return fmt::format("{:.1f} s", seconds);
    const auto whole = static_cast<std::int64_t>(std::llround(seconds));
    if (whole < kHour) return fmt::format("{}:{:02} min", whole / kMinute, whole % kMinute);
    return fmt::format("{}:{:02}:{:02} h", whole / kHour, whole / kMinute % kMinute, whole % kMinute);
}

std::string bytes_text(std::uint64_t bytes)
{
    if (bytes < 1000) return fmt::format("{} B", bytes);
    double value = static_cast<double>(bytes);
    const char* unit = "B";
    for (const char* larger : {"kB", "MB", "GB", "TB"}) {
        if (value < 1000.0) break;
        value /= 1000.0;
        unit = larger;
    }
    return fmt::format("{:.{}f} {}", value, value < 10.0 ? 1 : 0, unit);
}

std::string rate_text(double items_per_second)
{
    return fmt::format("{:.{}f}/s", items_per_second, items_per_second < 100.0 ? 1 : 0);
}

std::string count_text(std::uint64_t count, const std::string& thing)
{
    return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

std::uint64_t parse_bytes(const std::string& text, const std::string& flag)
{
    constexpr std::string_view kUnits = "KMGT";
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    std::string_view unit(end, text.data() + text.size());
    if (unit.ends_with('B')) unit.remove_suffix(1);
    const std::size_t power = unit.empty() ? 0 : kUnits.find(unit) + 1;
    const bool is_size = error == std::errc() && std::isfinite(value) && value > 0.0 && power <= kUnits.size() &&
                         (unit.empty() || (unit.size() == 1 && power > 0));
    if (!is_size) throw UsageError(fmt::format("{} is '{}': expected a size like 4G or 512M", flag, text));
    return static_cast<std::uint64_t>(std::ldexp(value, static_cast<int>(10 * power)));
}

double parse_duration(const std::string& text, const std::string& flag)
{
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const std::string_view unit(end, text.data() + text.size());
    constexpr double kMinute = 60.0;
    constexpr double kHour = 3600.0;
    const double factor = unit.empty() || unit == "s" ? 1.0 : unit == "m" ? kMinute : unit == "h" ? kHour : 0.0;
    if (error != std::errc() || !std::isfinite(value) || value <= 0.0 || factor == 0.0)
        throw UsageError(fmt::format("{} is '{}': expected a time like 90s, 30m or 2h", flag, text));
    return value * factor;
}

} // namespace quoin
