#pragma once

namespace quoin {

// From now on memory that is freed stays with the process and is used again. By default the C library hands every large
// buffer back to the system, so that the next one is paid for page by page anew: half of the time of stages that
// go through images or passes over a mesh.
void keep_freed_memory();

} // namespace quoin
