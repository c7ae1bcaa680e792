#include "stage/console_progress.h"

#include "base/progress.h"
#include "base/timer.h"

#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace quoin {
namespace {

constexpr double kBarInterval = 0.1;  // [s]
constexpr double kLineInterval = 5.0; // [s]
constexpr int kBarWidth = 24;

// When the part that is shown began, and when something was last shown.
struct Clock {
    std::string part;
    Timer part_time;
    double last_shown = -1e9;
};

std::string figures(const ProgressUpdate& update, double seconds)
{
    const double rate = seconds > 0.0 ? static_cast<double>(update.done) / seconds : 0.0;
    const double left =
        rate > 0.0 ? static_cast<double>(update.total - std::min(update.done, update.total)) / rate : 0.0;
    const double percent =
        update.total > 0 ? 100.0 * static_cast<double>(update.done) / static_cast<double>(update.total) : 0.0;
    return fmt::format("{:3.0f} %  {:.4g}/s  {:.0f} s left", percent, rate, left);
}

void show_bar(const std::string& stage, const ProgressUpdate& update, double seconds)
{
    const auto filled =
        update.total > 0 ? static_cast<std::size_t>(kBarWidth) * std::min(update.done, update.total) / update.total : 0;
    const std::string text = fmt::format("\r\x1b[K{} {} [{:<24}] {}", stage, update.part, std::string(filled, '#'),
                                         figures(update, seconds));
    std::fwrite(text.data(), 1, text.size(), stderr);
}

void show_line(const std::string& stage, const ProgressUpdate& update, double seconds)
{
    const std::string text = fmt::format("{}: {}: {}\n", stage, update.part, figures(update, seconds));
    std::fwrite(text.data(), 1, text.size(), stderr);
}

void show_json(const std::string&, const ProgressUpdate& update, double)
{
    const std::string text =
        nlohmann::json{{"part", update.part}, {"done", update.done}, {"total", update.total}}.dump() + "\n";
    std::fwrite(text.data(), 1, text.size(), stderr);
}

} // namespace

ConsoleProgress::ConsoleProgress(ProgressMode mode, std::string stage)
{
    if (mode == ProgressMode::None) return;
    on_terminal_ = mode == ProgressMode::Bar || (mode == ProgressMode::Auto && ::isatty(STDERR_FILENO) != 0);
    const auto show = mode == ProgressMode::Json ? show_json : on_terminal_ ? show_bar : show_line;
    const double interval = mode == ProgressMode::Json || on_terminal_ ? kBarInterval : kLineInterval;
    // On a pipe nothing is said before the first interval is over: quick stages stay quiet.
    const auto clock = std::make_shared<Clock>();
    const auto total_time = std::make_shared<Timer>();
    if (show == show_line) clock->last_shown = 0.0;
    set_progress_sink([=, name = std::move(stage)](const ProgressUpdate& update) {
        if (update.part != clock->part) {
            clock->part = update.part;
            clock->part_time = Timer();
        }
        const double now = total_time->seconds();
        const bool last = update.done == update.total && show != show_line;
        if (now - clock->last_shown < interval && !last) return;
        clock->last_shown = now;
        show(name, update, clock->part_time.seconds());
    });
}

ConsoleProgress::~ConsoleProgress()
{
    set_progress_sink({});
    if (on_terminal_) std::fputs("\r\x1b[K", stderr);
}

} // namespace quoin
