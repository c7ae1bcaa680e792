// What the stages promise about their planes: asserted at the end of each, so in debug builds; tests ask for it in
// others.
#pragma once

#include "mesh/plane_mesh.h"

#include <string>

namespace quoin {

// Of partition and merge: every face is in one plane, every plane has faces and moments and hangs together over edges.
// "" if so, else what is wrong. Where faces repeat a vertex, nothing is said about what hangs together.
std::string broken_promise_of_planes(const PlaneMesh& mesh);

// Of simplify: that, and no edge of three faces, bow-tie, repeated face, isolated vertex, or face that looks away from
// its plane.
std::string broken_promise_of_light_mesh(const PlaneMesh& mesh);

} // namespace quoin
