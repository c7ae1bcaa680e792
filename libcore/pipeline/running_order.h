// An order in which things can be done that wait for each other.
#pragma once

#include <cstddef>
#include <vector>

namespace quoin {

using Waits = std::vector<std::vector<std::size_t>>; // for each, the ones that it waits for

// Each behind what it waits for; of those that could come next, the one of the smallest index. What stands on a circle
// or behind one is left out.
std::vector<std::size_t> running_order(const Waits& waits);

// Circles among what running_order() leaves out, no two with a common member. Each is waited for by the next; the first
// stands again at the end.
std::vector<std::vector<std::size_t>> find_circles(const Waits& waits, const std::vector<std::size_t>& order);

} // namespace quoin
