#pragma once

#include <filesystem>

namespace quoin {

// True for a folder of `quoin emit slurm`.
bool is_submission(const std::filesystem::path& folder);

// Prints how far a submission is: what the store has, then what Slurm says of the rest.
void print_submission(const std::filesystem::path& folder);

} // namespace quoin
