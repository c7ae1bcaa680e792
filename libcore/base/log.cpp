#include "base/log.h"

#include "base/error.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

namespace quoin {
namespace {

spdlog::logger& logger()
{
    static const auto instance = [] {
        auto made = std::make_shared<spdlog::logger>("quoin", std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
        made->set_pattern("%^%l%$: %v");
        return made;
    }();
    return *instance;
}

} // namespace

void set_log_level(LogLevel level)
{
    constexpr spdlog::level::level_enum levels[] = {spdlog::level::debug, spdlog::level::info, spdlog::level::warn,
                                                    spdlog::level::err, spdlog::level::off};
    logger().set_level(levels[static_cast<int>(level)]);
}

LogLevel parse_log_level(std::string_view text)
{
    constexpr std::string_view names[] = {"debug", "info", "warning", "error", "off"};
    for (int i = 0; i < 5; ++i)
        if (text == names[i]) return static_cast<LogLevel>(i);
    throw UsageError("--log-level is '" + std::string(text) + "': expected debug, info, warning, error or off");
}

void log_debug(const std::string& message) { logger().debug(message); }
void log_info(const std::string& message) { logger().info(message); }
void log_warning(const std::string& message) { logger().warn(message); }
void log_error(const std::string& message) { logger().error(message); }

} // namespace quoin
