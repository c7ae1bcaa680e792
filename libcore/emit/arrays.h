// How the stale tasks of a run become Slurm arrays: one a stage where possible, an element for every scan.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace quoin {

// A stage as far as arrays go.
struct ArrayStage {
    std::string name;
    std::vector<std::size_t> after; // stages, always smaller than its own index
    std::vector<bool> is_stale;     // one a scan
};

struct JobArray {
    std::string name; // "fuse.1"
    std::size_t stage = 0;
    std::size_t offset = 0;            // scan = offset + element
    std::vector<std::size_t> elements; // ascending, below `max_array`
    std::vector<std::size_t> follows;  // arrays whose element of the same number must be done first, ascending
};

// An element that an array lacks would make its follower wait for the whole array and fall with any of its elements; so
// scans of a stage share an array only when the same arrays make what they read. Arrays of more scans than `max_array`
// are split at its multiples.
std::vector<JobArray> plan_arrays(const std::vector<ArrayStage>& stages, std::size_t max_array);

// "0-3,7,9-12"
std::string elements_text(const std::vector<std::size_t>& elements);

} // namespace quoin
