#include "pipeline/forecast.h"

#include "pipeline/process.h"
#include "store/store.h"

#include <algorithm>
#include <map>
#include <optional>

namespace quoin {
namespace fs = std::filesystem;
namespace {

constexpr double kKeySeconds = 600.0; // the first key of a scan hashes all its images

using Outputs = std::map<std::string, std::string>; // port -> payload

class Forecaster {
public:
    Forecaster(const std::vector<Task>& tasks, const fs::path& root)
        : tasks_(tasks), root_(root), store_(root), forecasts_(tasks.size(), Forecast::Follows), known_(tasks.size()),
          is_asked_(tasks.size(), false)
    {
    }

    std::vector<Forecast> run()
    {
        for (auto wave = next_wave(); !wave.empty(); wave = next_wave())
            ask(wave);
        return forecasts_;
    }

private:
    // The tasks whose inputs are known and whose keys are not.
    std::vector<std::size_t> next_wave() const
    {
        std::vector<std::size_t> wave;
        for (std::size_t i = 0; i < tasks_.size(); ++i) {
            const bool is_known = std::ranges::all_of(tasks_[i].inputs, [&](const TaskInput& input) {
                return !input.from || known_[*input.from].has_value();
            });
            if (is_known && !is_asked_[i]) wave.push_back(i);
        }
        return wave;
    }

    // Inputs are read in the store, as nothing has linked them into their places.
    Command key_command(Task task) const
    {
        for (auto& input : task.inputs)
            if (input.from) input.path = store_.object(known_[*input.from]->at(input.from_port));
        std::vector<std::string> arguments = arguments_of(task, root_);
        arguments.emplace_back("--key");
        return {task.program, arguments};
    }

    void ask(const std::vector<std::size_t>& wave)
    {
        std::vector<Command> commands;
        for (const std::size_t task : wave)
            commands.push_back(key_command(tasks_[task]));
        const auto answers = capture_all(commands, kKeySeconds);
        for (std::size_t i = 0; i < wave.size(); ++i) {
            const std::size_t task = wave[i];
            is_asked_[task] = true;
            known_[task] = find_outputs(answers[i]);
            const bool is_cached = known_[task].has_value() && !tasks_[task].is_forced;
            forecasts_[task] = is_cached ? Forecast::Cached : Forecast::Compute;
        }
    }

    // A stage that cannot say its key will say why when it runs.
    std::optional<Outputs> find_outputs(const Captured& answer) const
    {
        const std::size_t line = answer.output.find('\n');
        if (answer.exit_code != 0 || answer.timed_out || line == std::string::npos) return std::nullopt;
        const std::string json = answer.output.substr(line + 1, answer.output.find_last_not_of('\n') - line);
        const auto entry = store_.find({json, answer.output.substr(0, line)});
        return entry ? std::optional(entry->outputs) : std::nullopt;
    }

    const std::vector<Task>& tasks_;
    fs::path root_;
    Store store_;
    std::vector<Forecast> forecasts_;
    std::vector<std::optional<Outputs>> known_; // what the store has of each task
    std::vector<bool> is_asked_;
};

} // namespace

std::vector<Forecast> forecast_tasks(const std::vector<Task>& tasks, const fs::path& store)
{
    if (fs::is_directory(store)) return Forecaster(tasks, store).run();
    std::vector<Forecast> forecasts; // no store yet: nothing is known, and asking would make one
    for (const auto& task : tasks)
        forecasts.push_back(task.after.empty() ? Forecast::Compute : Forecast::Follows);
    return forecasts;
}

std::string_view forecast_text(Forecast forecast)
{
    constexpr std::string_view texts[] = {"in the store", "to compute", "follows"};
    return texts[static_cast<int>(forecast)];
}

} // namespace quoin
