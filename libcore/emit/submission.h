// What became of the elements of submitted arrays, as far as Slurm knows. The store knows better what is done.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace quoin {

// A line of jobs.tsv, which submit.sh writes; later lines are later submissions.
struct SubmittedArray {
    std::string job;
    std::string name; // "fuse.1"
    std::size_t offset = 0;
    std::vector<std::size_t> elements;
};

std::vector<SubmittedArray> parse_jobs(const std::string& text);

// A line of `squeue -h -r -t all -o "%F %K %T"`.
struct QueuedElement {
    std::string job;
    std::size_t element = 0;
    std::string state; // "RUNNING"
};

std::vector<QueuedElement> parse_queue(const std::string& text);

struct ElementState {
    std::string text = "not submitted";
    std::string log;        // name of the log file, when it was submitted
    bool has_ended = false; // without a result, when the store lacks it
};

class ElementStates {
public:
    ElementStates(const std::vector<SubmittedArray>& arrays, const std::vector<QueuedElement>& queue);

    // Of a stage of a scan, in the last submission that had it; in the mode `chain`, of the whole scan.
    ElementState of(const std::string& stage, std::size_t scan) const;

private:
    std::map<std::string, std::map<std::size_t, ElementState>> states_; // by stage and scan
};

} // namespace quoin
