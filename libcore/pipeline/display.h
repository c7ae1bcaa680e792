// Shows a run to a person: on a terminal one live line a running task and a summary below them, elsewhere one line an
// event.
#pragma once

#include "base/timer.h"
#include "pipeline/scheduler.h"

#include <map>
#include <string>
#include <vector>

namespace quoin {

class Display : public RunObserver {
public:
    // Writes to stderr. With several scans, the lines name the scan.
    Display(const std::vector<Task>& tasks, bool on_terminal);
    ~Display() override;
    Display(const Display&) = delete;
    Display& operator=(const Display&) = delete;

    void started(std::size_t task) override;
    void progressed(std::size_t task, const TaskProgress& progress) override;
    void said(std::size_t task, const std::string& line) override;
    void ended(std::size_t task, const TaskResult& result) override;
    void tick() override;

private:
    struct Live {
        TaskProgress progress;
        Timer timer;                   // since the task began
        Timer since_printed;           // its last line, off a terminal
        Timer part_timer;              // since its part began
        std::size_t done_at_start = 0; // of the part
    };
    std::string live_line(std::size_t task, const Live& live) const;
    void print(const std::string& line);
    void print_due_lines();
    std::string summary_line() const;
    void erase_live_lines();
    void draw_live_lines();

    std::vector<std::string> labels_; // one a task
    std::size_t label_width_ = 0;
    bool has_many_scans_ = false; // whose stored results are counted only
    std::size_t computed_ = 0, stored_ = 0, failed_ = 0;
    Timer timer_;
    bool on_terminal_;
    std::map<std::size_t, Live> live_;
    std::size_t drawn_lines_ = 0;
    Timer since_drawn_;
};

} // namespace quoin
