#pragma once

#include "fill/patch.h"

#include <vector>

namespace quoin {

// Closes bays of a border that nothing closes as a whole: gaps behind a narrow mouth, which stays a border. A bay's
// mouth is at most max_gap wide and a small part of its border; what closes it covers no other vertex of the border.
std::vector<Patch> close_pockets(const PlaneMesh& mesh, const BorderLoop& loop, const Proposer& proposer,
                                 const FillHolesParams& params);

} // namespace quoin
