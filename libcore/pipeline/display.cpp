#include "pipeline/display.h"

#include "pipeline/text_figures.h"

#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace quoin {
namespace {

constexpr double kFrameSeconds = 0.1; // between two drawings on a terminal
constexpr double kLineSeconds = 5.0;  // between two progress lines elsewhere

bool are_of_one_scan(const std::vector<Task>& tasks)
{
    return std::ranges::all_of(tasks, [&](const Task& task) { return task.scan == tasks.front().scan; });
}

std::vector<std::string> make_labels(const std::vector<Task>& tasks)
{
    const bool has_one_scan = are_of_one_scan(tasks);
    std::vector<std::string> labels;
    for (const auto& task : tasks)
        labels.push_back(has_one_scan ? task.stage : task.scan + "/" + task.stage);
    return labels;
}

struct Extent {
    std::size_t columns = 80;
    std::size_t rows = 24;
};

Extent terminal_extent()
{
    winsize size{};
    if (::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0) return {};
    return {size.ws_col, size.ws_row};
}

std::string bar(double fraction)
{
    constexpr std::size_t kWidth = 20;
    const auto full = static_cast<std::size_t>(fraction * kWidth);
    return std::string(full, '#') + std::string(kWidth - full, '.');
}

// What a task was and used; the figures of a result from the store are those of the run that computed it.
std::string end_text(const TaskResult& result)
{
    const std::uint64_t memory = result.record ? result.record->peak_memory_bytes : result.end.peak_memory_bytes;
    switch (result.state) {
    case TaskState::Computed:
        return fmt::format("done in {}, {}", duration_text(result.seconds), bytes_text(memory));
    case TaskState::Cached:
        return fmt::format("in the store (took {}, {})", duration_text(result.record->seconds), bytes_text(memory));
    case TaskState::Stopped:
        return "stopped";
    case TaskState::Failed:
    case TaskState::NotRun:
        break;
    }
    return fmt::format("failed (exit code {})", result.end.exit_code);
}

void write_line(const std::string& text) { std::fwrite(text.data(), 1, text.size(), stderr); }

} // namespace

Display::Display(const std::vector<Task>& tasks, bool on_terminal)
    : labels_(make_labels(tasks)), has_many_scans_(!are_of_one_scan(tasks)), on_terminal_(on_terminal)
{
    for (const auto& label : labels_)
        label_width_ = std::max(label_width_, label.size());
}

Display::~Display() { erase_live_lines(); }

void Display::started(std::size_t task)
{
    live_[task] = {};
    draw_live_lines();
}

void Display::progressed(std::size_t task, const TaskProgress& progress)
{
    Live& live = live_[task];
    if (live.progress.part != progress.part) {
        live.part_timer = Timer();
        live.done_at_start = progress.done;
    }
    live.progress = progress;
}

void Display::said(std::size_t task, const std::string& line)
{
    // A stage's own error message begins with its name.
    const bool names_itself = labels_[task].ends_with(line.substr(0, line.find(':')));
    const std::size_t slash = labels_[task].find('/');
    const std::string scan = slash == std::string::npos ? "" : labels_[task].substr(0, slash + 1);
    print(names_itself ? scan + line : labels_[task] + ": " + line);
}

void Display::ended(std::size_t task, const TaskResult& result)
{
    live_.erase(task);
    computed_ += result.state == TaskState::Computed;
    stored_ += result.state == TaskState::Cached;
    failed_ += result.state == TaskState::Failed;
    if (has_many_scans_ && result.state == TaskState::Cached) return; // a hundred scans would hide what happens
    print(fmt::format("{:<{}}  {}", labels_[task], label_width_, end_text(result)));
}

void Display::tick()
{
    if (!on_terminal_) return print_due_lines();
    if (since_drawn_.seconds() < kFrameSeconds) return;
    since_drawn_ = Timer();
    draw_live_lines();
}

// Stages that take less than the interval stay quiet.
void Display::print_due_lines()
{
    for (auto& [task, live] : live_) {
        if (live.since_printed.seconds() < kLineSeconds) continue;
        live.since_printed = Timer();
        write_line(live_line(task, live) + "\n");
    }
}

std::string Display::live_line(std::size_t task, const Live& live) const
{
    const TaskProgress& progress = live.progress;
    std::string text = fmt::format("{:<{}}  ", labels_[task], label_width_);
    if (progress.total == 0) return text + fmt::format("running, {}", duration_text(live.timer.seconds()));
    const double fraction = std::min(1.0, static_cast<double>(progress.done) / static_cast<double>(progress.total));
    if (on_terminal_) text += bar(fraction) + " ";
    text += fmt::format("{:3.0f} %  {}", 100.0 * fraction, progress.part);
    const double seconds = live.part_timer.seconds();
    const double rate = seconds > 0.0
                            ? static_cast<double>(progress.done - std::min(progress.done, live.done_at_start)) / seconds
                            : 0.0;
    if (rate <= 0.0 || progress.done >= progress.total) return text;
    return text + fmt::format("  {}  {} left", rate_text(rate),
                              duration_text(static_cast<double>(progress.total - progress.done) / rate));
}

void Display::print(const std::string& line)
{
    erase_live_lines();
    write_line(line + "\n");
    draw_live_lines();
}

void Display::erase_live_lines()
{
    if (drawn_lines_ > 0) write_line(fmt::format("\x1b[{}F\x1b[J", drawn_lines_)); // up to their first, clear below
    drawn_lines_ = 0;
}

std::string Display::summary_line() const
{
    std::string text = fmt::format("{} of {} stages", computed_ + stored_, labels_.size());
    if (stored_ > 0) text += fmt::format(", {} of them in the store", stored_);
    if (!live_.empty()) text += fmt::format(", {} running", live_.size());
    if (failed_ > 0) text += fmt::format(", {} failed", failed_);
    return text + ", " + duration_text(timer_.seconds());
}

// As many running tasks as fit, and the summary.
void Display::draw_live_lines()
{
    if (!on_terminal_) return;
    erase_live_lines();
    const Extent terminal = terminal_extent();
    constexpr std::size_t kOtherRows = 3; // summary, the line that says how many are not shown, the cursor
    const std::size_t most = std::max<std::size_t>(1, terminal.rows - std::min(terminal.rows, kOtherRows));
    const auto draw = [&](const std::string& line) {
        write_line(line.substr(0, terminal.columns - 1) + "\n");
        ++drawn_lines_;
    };
    std::size_t shown = 0;
    for (const auto& [task, live] : live_)
        if (shown < most && ++shown > 0) draw(live_line(task, live));
    if (shown < live_.size()) draw(fmt::format("... and {} more", live_.size() - shown));
    if (has_many_scans_ && !live_.empty()) draw(summary_line());
}

} // namespace quoin
