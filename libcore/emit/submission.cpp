#include "emit/submission.h"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <sstream>

namespace quoin {
namespace {

std::size_t number_in(std::string_view text)
{
    std::size_t number = 0;
    std::from_chars(text.data(), text.data() + text.size(), number);
    return number;
}

// "0-3,7%2"
std::vector<std::size_t> parse_elements(const std::string& text)
{
    std::vector<std::size_t> elements;
    std::istringstream ranges(text.substr(0, text.find('%')));
    for (std::string range; std::getline(ranges, range, ',');) {
        const std::size_t dash = range.find('-');
        const std::size_t first = number_in(range);
        const std::size_t last =
            dash == std::string::npos ? first : number_in(std::string_view(range).substr(dash + 1));
        for (std::size_t element = first; element <= last; ++element)
            elements.push_back(element);
    }
    return elements;
}

ElementState state_of(const std::string& slurm)
{
    if (slurm == "PENDING" || slurm == "REQUEUED" || slurm == "REQUEUE_HOLD") return {"waiting", {}, false};
    if (slurm == "RUNNING" || slurm == "COMPLETING" || slurm == "CONFIGURING") return {"running", {}, false};
    if (slurm == "CANCELLED") return {"cancelled", {}, true};
    if (slurm == "COMPLETED") return {"done, yet not in the store", {}, true};
    if (slurm == "TIMEOUT" || slurm == "PREEMPTED") return {"out of time", {}, true};
    if (slurm == "OUT_OF_MEMORY") return {"out of memory", {}, true};
    return {"failed", {}, true};
}

} // namespace

std::vector<SubmittedArray> parse_jobs(const std::string& text)
{
    std::vector<SubmittedArray> arrays;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream fields(line);
        std::string job, name, script, offset, elements;
        if (fields >> job >> name >> script >> offset >> elements)
            arrays.push_back({job, name, number_in(offset), parse_elements(elements)});
    }
    return arrays;
}

std::vector<QueuedElement> parse_queue(const std::string& text)
{
    std::vector<QueuedElement> queue;
    std::istringstream lines(text);
    std::string job, element, state;
    while (lines >> job >> element >> state)
        queue.push_back({job, number_in(element), state});
    return queue;
}

ElementStates::ElementStates(const std::vector<SubmittedArray>& arrays, const std::vector<QueuedElement>& queue)
{
    for (const auto& array : arrays) {
        const std::string stage = array.name.substr(0, array.name.rfind('.'));
        for (const std::size_t element : array.elements) {
            const auto queued = std::ranges::find_if(
                queue, [&](const QueuedElement& q) { return q.job == array.job && q.element == element; });
            // Slurm forgets jobs some minutes after their end.
            ElementState state =
                queued == queue.end() ? ElementState{"ended without a result", {}, true} : state_of(queued->state);
            state.log = fmt::format("quoin-{}.{}_{}.log", stage, array.job, element);
            states_[stage][array.offset + element] = state;
        }
    }
}

ElementState ElementStates::of(const std::string& stage, std::size_t scan) const
{
    for (const auto& name : {stage, std::string("chain")})
        if (const auto scans = states_.find(name); scans != states_.end())
            if (const auto state = scans->second.find(scan); state != scans->second.end()) return state->second;
    return {};
}

} // namespace quoin
