// Log lines on stderr. Messages are whole sentences with units; `fmt::format` them at the call.
#pragma once

#include <string>
#include <string_view>

namespace quoin {

enum class LogLevel { Debug, Info, Warning, Error, Off };

void set_log_level(LogLevel level);
// "debug", "info", "warning", "error" or "off"; throws UsageError otherwise.
LogLevel parse_log_level(std::string_view text);

void log_debug(const std::string& message);
void log_info(const std::string& message);
void log_warning(const std::string& message);
void log_error(const std::string& message);

} // namespace quoin
