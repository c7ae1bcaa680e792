#pragma once

#include <cstdint>
#include <vector>

namespace quoin {

// A plane mesh or textured mesh, and which of its faces close holes that the scan left.
template <class Mesh>
struct Filled {
    Mesh mesh;
    std::vector<std::uint8_t> face_filled; // F; 1 = closes a hole. Empty: nothing is known of it
};

} // namespace quoin
