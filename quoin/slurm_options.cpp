#include "quoin/slurm_options.h"

#include "pipeline/locate.h"
#include "pipeline/process.h"
#include "quoin/option_parser.h"

#include <charconv>

namespace quoin {
namespace {

namespace fs = std::filesystem;

// Slurm's own limit where there is a Slurm to ask, else its default.
std::size_t max_array_size()
{
    constexpr std::size_t kDefault = 1001;
    constexpr double kSeconds = 10.0;
    const fs::path scontrol = find_in_path("scontrol");
    if (scontrol.empty()) return kDefault;
    const std::string config = capture_all({{scontrol, {"show", "config"}}}, kSeconds).front().output;
    const std::size_t digits = config.find_first_of("0123456789", config.find("MaxArraySize"));
    std::size_t size = 0;
    if (digits != std::string::npos) std::from_chars(config.data() + digits, config.data() + config.size(), size);
    return size > 0 ? size : kDefault;
}

} // namespace

void SlurmRun::add_to(OptionParser& parser)
{
    run.add_to(parser);
    slurm.max_array = 0;
    parser.option("--to", folder, "the folder of the scripts, where every node sees it").show_default();
    parser.option("--mode", mode, "stages: an array a stage; chain: one array, an element runs the whole pipeline")
        .show_default()
        .one_of({"stages", "chain"});
    parser.flag("--all", all, "submit every scan and stage, without asking the store what it has");
    parser.option("--threads", slurm.threads, "cores of an element").show_default().positive();
    parser.option("--mem", slurm.memory, "memory of a stage that the store has no record of").show_default();
    parser.option("--minutes", slurm.minutes, "time limit of such a stage").show_default().positive();
    parser.option("--max-running", slurm.max_running, "elements of an array that run side by side (default: all)")
        .positive();
    parser.option("--max-array-size", slurm.max_array, "Slurm's MaxArraySize (default: ask scontrol, or 1001)")
        .positive();
    parser.repeated("--sbatch", slurm.directives, "a further option of sbatch, like --partition=long");
}

fs::path SlurmRun::write()
{
    const Emission emission = run.load();
    slurm.folder = fs::absolute(folder).lexically_normal();
    if (!slurm.folder.has_filename()) slurm.folder = slurm.folder.parent_path();
    slurm.is_chain = mode == "chain";
    if (slurm.max_array == 0) slurm.max_array = max_array_size();
    const auto forecasts = all ? std::vector<Forecast>(emission.tasks.size(), Forecast::Compute)
                               : forecast_tasks(emission.tasks, emission.layout.store);
    const auto arrays = slurm_arrays(emission, forecasts, slurm);
    write_slurm_folder(slurm_scripts(emission, arrays, recorded_costs(emission.layout.store), slurm), slurm);
    return slurm.folder;
}

} // namespace quoin
