// Why a stage runs, or does not: the key of every task is compared with that of its last run in this place, or else
// with the nearest that the store has of the same stage, and changed inputs are followed to what changed them.
#pragma once

#include "pipeline/forecast.h"
#include "pipeline/graph.h"
#include "pipeline/plan.h"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace quoin {

struct Cause {
    std::vector<std::string> way; // from the task back to the cause: "mesh changed", "simplify must run", ...
    std::string text;             // "param max_error 0.1 -> 0.2 (pipeline.yaml:31:14)"
};

struct Explanation {
    Forecast forecast = Forecast::Compute;
    bool is_compared = false;    // there was an earlier run to compare with
    std::vector<Cause> causes;   // of the coming run; of the last one where the store has the result
    std::vector<Cause> cut_offs; // why it does not run: a stage before it ran with another key, and gave the same
};

class Explainer {
public:
    // The graph and the tasks must outlive it.
    Explainer(const Graph& graph, const std::vector<Task>& tasks, const std::filesystem::path& store);
    ~Explainer();
    Explainer(const Explainer&) = delete;
    Explainer& operator=(const Explainer&) = delete;

    Explanation explain(std::size_t task) const;

private:
    void add_cut_offs(std::size_t task, Explanation& explanation) const;

    class Known;
    std::unique_ptr<const Known> known_;
};

// As lines for a person.
std::string explanation_text(const Task& task, const Explanation& explanation);

} // namespace quoin
