#include "base/error.h"
#include "quoin/option_parser.h"
#include "quoin/slurm_options.h"

#include <fmt/format.h>
#include <unistd.h>

namespace quoin {

// Becomes submit.sh, which needs no quoin: what a person could also type.
int submit_verb(const Arguments& arguments)
{
    OptionParser parser(
        "writes a run as Slurm scripts (`quoin emit slurm`), asks Slurm whether it could run them, and submits "
        "them all",
        "quoin submit");
    SlurmRun run;
    run.add_to(parser);
    if (!parser.parse(arguments)) return 0;
    const std::string script = (run.write() / "submit.sh").string();
    ::execl("/bin/bash", "bash", script.c_str(), nullptr);
    throw UsageError("/bin/bash cannot be run; the scripts need it");
}

} // namespace quoin
