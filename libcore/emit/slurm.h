// A pipeline on several scans as a folder of Slurm scripts that need the stage executables and bash, not quoin:
//
//     scans.tsv      the scans and their numbers      stages.sh      places, and a command line a stage
//     NN-STAGE.sh    a batch script a stage           submit.sh      submits the arrays with their dependencies
//     pipeline.yaml, run.json    for `quoin status`   logs/          one a stage and element
#pragma once

#include "emit/arrays.h"
#include "emit/history.h"
#include "emit/rules.h"
#include "pipeline/forecast.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace quoin {

struct SlurmOptions {
    std::filesystem::path folder;        // absolute
    bool is_chain = false;               // one array, every element the whole pipeline
    int threads = 4;                     // of a task
    std::string memory = "4G";           // of a stage that the store has no record of
    int minutes = 60;                    // likewise
    std::size_t max_array = 1001;        // Slurm's MaxArraySize: elements are below it
    int max_running = 0;                 // elements of an array side by side; 0 = as many as there is room for
    std::vector<std::string> directives; // further options of sbatch: "--partition=long"
};

struct SlurmScript {
    std::string name; // "02-fuse.sh"
    std::string text;
};

// The arrays that compute what the store lacks; `forecasts` has one entry a task. In the mode `chain`, one stage.
std::vector<JobArray> slurm_arrays(const Emission& emission, const std::vector<Forecast>& forecasts,
                                   const SlurmOptions& options);

// Every file of the folder.
std::vector<SlurmScript> slurm_scripts(const Emission& emission, const std::vector<JobArray>& arrays,
                                       const std::map<std::string, StageCost>& costs, const SlurmOptions& options);

// Writes them; throws InputError or ResourceError.
void write_slurm_folder(const std::vector<SlurmScript>& scripts, const SlurmOptions& options);

} // namespace quoin
