#include "pipeline/explain.h"

#include "pipeline/key_difference.h"
#include "pipeline/run_record.h"
#include "pipeline/task_keys.h"
#include "store/inventory.h"
#include "store/run_file.h"

#include <algorithm>
#include <deque>
#include <fmt/format.h>
#include <map>
#include <optional>
#include <set>

namespace quoin {
namespace fs = std::filesystem;

// What the store tells of all tasks.
class Explainer::Known {
public:
    Known(const Graph& graph, const std::vector<Task>& tasks, const fs::path& root) : graph_(graph), tasks_(tasks)
    {
        std::optional<Store> store; // without one nothing is known, and asking makes none
        if (fs::is_directory(root)) store.emplace(root);
        if (store) read_past(*store);
        find_keys(store);
        for (std::size_t i = 0; i < tasks.size(); ++i)
            compare(i);
    }

    struct TaskState {
        Forecast forecast = Forecast::Follows;
        std::string key;                // "" = not known yet
        std::string key_json;           // without the inputs that are not known
        std::vector<KeyChange> changes; // since the run that it is compared with
        bool is_compared = false;
        std::vector<std::string> unknown; // ports whose content is not known yet
    };

    const TaskState& state(std::size_t task) const { return states_[task]; }
    const Task& task(std::size_t task) const { return tasks_[task]; }

    // "param max_error 0.1 -> 0.2 (pipeline.yaml:31:14)"
    std::string text(std::size_t index, const KeyChange& change) const
    {
        const GraphNode& node = graph_.nodes[tasks_[index].node];
        const auto or_none = [](const std::string& value) { return value.empty() ? std::string("none") : value; };
        const std::string values = fmt::format("{} -> {}", or_none(change.before), or_none(change.after));
        if (change.kind == KeyChange::Kind::Other) return fmt::format("{} {}", change.name, values);
        const auto set = std::ranges::find(node.params, change.name, &GraphParam::name);
        return fmt::format("param {} {} ({})", change.name, values,
                           set == node.params.end() ? "the stage's default" : to_string(set->position));
    }

    // The earlier run of the task in this place that had another key and gave the same, if its last runs are such.
    std::optional<std::vector<KeyChange>> changes_without_effect(std::size_t index) const
    {
        const TaskState& now = states_[index];
        const auto current = entries_.find(now.key);
        if (now.forecast != Forecast::Cached || !now.is_compared || current == entries_.end()) return std::nullopt;
        const auto before = entries_.find(base_key_[index]);
        if (before == entries_.end() || before->second.outputs != current->second.outputs) return std::nullopt;
        return now.changes;
    }

private:
    void read_past(const Store& store)
    {
        for (auto& item : inventory_entries(store))
            if (!item.is_damaged) {
                keys_of_stage_[item.stage].push_back(item.key);
                entries_.emplace(item.key, std::move(item.entry));
            }
        auto files = run_files(store);
        std::ranges::reverse(files);
        for (const auto& file : files) {
            const RunHistory run = read_run_file(file);
            for (const auto& task : run.tasks)
                if (!task.key.empty()) add_past(task.variant, task.scan, task.stage, task.key);
        }
    }

    void add_past(const std::string& variant, const std::string& scan, const std::string& stage, const std::string& key)
    {
        auto& keys = past_[(variant.empty() ? scan : variant + "/" + scan) + "/" + stage];
        if (keys.empty() || keys.back() != key) keys.push_back(key);
    }

    void find_keys(const std::optional<Store>& store)
    {
        states_.resize(tasks_.size());
        base_key_.resize(tasks_.size());
        TaskKeys keys(tasks_, store ? store->stat_cache() : fs::path());
        for (std::size_t i = 0; i < tasks_.size(); ++i) {
            TaskState& state = states_[i];
            for (const auto& input : tasks_[i].inputs)
                if (input.from && !keys.payload(*input.from, input.from_port)) state.unknown.push_back(input.port);
            const auto key = state.unknown.empty() && store ? keys.key(i) : std::nullopt;
            const auto entry = key ? store->find(*key) : std::nullopt;
            if (state.unknown.empty())
                state.forecast = entry && !tasks_[i].is_forced ? Forecast::Cached : Forecast::Compute;
            if (entry) keys.set_outputs(i, entry->outputs);
            state.key = key ? key->hex : "";
            state.key_json = key ? key->json : partial_key(i, keys);
        }
    }

    std::string partial_key(std::size_t index, const TaskKeys& keys) const
    {
        if (!tasks_[index].key) return {};
        KeyParts parts = *tasks_[index].key;
        for (const auto& input : tasks_[index].inputs)
            if (const auto payload = input.from ? keys.payload(*input.from, input.from_port) : std::nullopt)
                parts.inputs[input.port] = {tasks_[*input.from].key->outputs.at(input.from_port), *payload};
        return make_key(parts).json;
    }

    // The last run in this place with another key; before there was one, the nearest of the stage's entries.
    void compare(std::size_t index)
    {
        TaskState& state = states_[index];
        if (state.key_json.empty()) return;
        const auto take = [&](const std::string& key) {
            const auto entry = entries_.find(key);
            if (key == state.key || entry == entries_.end()) return false;
            auto changes = changes_since(entry->second.key_json, state);
            if (state.is_compared && changes.size() >= state.changes.size()) return true;
            state.is_compared = true;
            state.changes = std::move(changes);
            base_key_[index] = key;
            return true;
        };
        if (const auto record = read_run_record(tasks_[index].record); record && take(record->key)) return;
        for (const auto& key : past_[tasks_[index].scan + "/" + tasks_[index].stage])
            if (take(key)) return;
        if (state.forecast == Forecast::Cached) return; // it is its first run here that gave the result
        for (const auto& key : keys_of_stage_[graph_.nodes[tasks_[index].node].program.description.name])
            take(key);
    }

    // Inputs that are not known yet are no change: what makes them is asked instead.
    static std::vector<KeyChange> changes_since(const std::string& before, const TaskState& state)
    {
        auto changes = key_difference(before, state.key_json);
        std::erase_if(changes, [&](const KeyChange& change) {
            return change.kind == KeyChange::Kind::Input && state.key.empty() && change.after.empty();
        });
        return changes;
    }

    const Graph& graph_;
    const std::vector<Task>& tasks_;
    std::vector<TaskState> states_;
    std::vector<std::string> base_key_;         // that each is compared with
    std::map<std::string, StoreEntry> entries_; // by key
    std::map<std::string, std::vector<std::string>> keys_of_stage_;
    std::map<std::string, std::vector<std::string>> past_; // keys by "scan/stage", the last first
};

namespace {

std::string verb(Forecast forecast)
{
    constexpr const char* verbs[] = {"reran", "must run", "may run"};
    return verbs[static_cast<int>(forecast)];
}

const TaskInput* find_input(const Task& task, const std::string& port)
{
    const auto input = std::ranges::find(task.inputs, port, &TaskInput::port);
    return input == task.inputs.end() ? nullptr : &*input;
}

} // namespace

Explainer::Explainer(const Graph& graph, const std::vector<Task>& tasks, const fs::path& store)
    : known_(std::make_unique<const Known>(graph, tasks, store))
{
}

Explainer::~Explainer() = default;

namespace {

struct Visit {
    std::size_t task;
    std::vector<std::string> way;
};

} // namespace

Explanation Explainer::explain(std::size_t index) const
{
    const auto& first = known_->state(index);
    Explanation explanation{first.forecast, first.is_compared, {}, {}};
    std::set<std::size_t> seen{index};
    std::deque<Visit> open{{index, {}}};
    while (!open.empty()) {
        const Visit visit = std::move(open.front());
        open.pop_front();
        const Task& task = known_->task(visit.task);
        const auto& state = known_->state(visit.task);
        const auto follow = [&](const TaskInput& input, const char* what) {
            if (!seen.insert(*input.from).second) return;
            Visit next{*input.from, visit.way};
            next.way.push_back(fmt::format("{} {}", input.port, what));
            next.way.push_back(
                fmt::format("{} {}", known_->task(*input.from).stage, verb(known_->state(*input.from).forecast)));
            open.push_back(std::move(next));
        };
        for (const auto& change : state.changes) {
            const TaskInput* input = change.kind == KeyChange::Kind::Input ? find_input(task, change.name) : nullptr;
            if (input && input->from)
                follow(*input, "changed");
            else if (change.kind == KeyChange::Kind::Input)
                explanation.causes.push_back({visit.way, fmt::format("input {} changed ({:.12} -> {:.12})", change.name,
                                                                     change.before, change.after)});
            else
                explanation.causes.push_back({visit.way, known_->text(visit.task, change)});
        }
        for (const auto& port : state.unknown)
            follow(*find_input(task, port), "is made by");
        const bool runs = state.forecast != Forecast::Cached;
        if (runs && !state.is_compared) explanation.causes.push_back({visit.way, "no earlier run to compare with"});
        if (runs && task.is_forced) explanation.causes.push_back({visit.way, "--force " + task.stage});
    }
    if (first.forecast == Forecast::Cached) add_cut_offs(index, explanation);
    return explanation;
}

void Explainer::add_cut_offs(std::size_t index, Explanation& explanation) const
{
    std::set<std::size_t> seen{index};
    std::deque<std::size_t> open{index};
    while (!open.empty()) {
        const std::size_t at = open.front();
        open.pop_front();
        for (const auto& input : known_->task(at).inputs) {
            if (!input.from || !seen.insert(*input.from).second) continue;
            open.push_back(*input.from);
            const auto changes = known_->changes_without_effect(*input.from);
            if (!changes || changes->empty()) continue;
            const KeyChange& change = changes->front();
            explanation.cut_offs.push_back(
                {{},
                 fmt::format("{} ran with {}, but its {} came out the same: cut off there",
                             known_->task(*input.from).stage, known_->text(*input.from, change), input.from_port)});
        }
    }
}

std::string explanation_text(const Task& task, const Explanation& explanation)
{
    const bool is_stored = explanation.forecast == Forecast::Cached;
    std::string text = fmt::format("{}/{} {}\n", task.scan, task.stage,
                                   is_stored ? "is up to date: the store has its result" : verb(explanation.forecast));
    for (const auto& cut_off : explanation.cut_offs)
        text += "  it did not run again: " + cut_off.text + "\n";
    if (is_stored && explanation.causes.empty()) return text;
    if (is_stored) text += "  it last changed because\n";
    for (const auto& cause : explanation.causes) {
        text += "  ";
        for (const auto& step : cause.way)
            text += "<- " + step + " ";
        text += "<- " + cause.text + "\n";
    }
    return text;
}

} // namespace quoin
