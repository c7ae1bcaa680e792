// The options of `quoin emit slurm` and `quoin submit`.
#pragma once

#include "emit/slurm.h"
#include "quoin/emission.h"

namespace quoin {

struct SlurmRun {
    EmissionOptions run;
    SlurmOptions slurm;
    std::string folder = "slurm";
    std::string mode = "stages";
    bool all = false;

    void add_to(OptionParser& parser);

    // Writes the folder and returns its path. Throws UsageError or InputError.
    std::filesystem::path write();
};

} // namespace quoin
