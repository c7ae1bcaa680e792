#pragma once

#include "simplify/curves.h"
#include "simplify/simplify.h"

namespace quoin {

// Edge contraction by quadrics inside the planes and along the curves of the mesh, in turn: fewer vertices on one side
// make room for contractions on the other.
void contract(PlaneMesh& mesh, Curves& curves, const SimplifyParams& params);

} // namespace quoin
