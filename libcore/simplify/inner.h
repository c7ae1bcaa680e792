#pragma once

#include "simplify/simplify.h"

namespace quoin {

// Contracts edges inside every plane, planes in parallel: inner vertices into each other, to where their quadric is
// smallest, and into border vertices, which stay where they are. Faces come out ordered by plane; vertices keep their
// ids.
void simplify_inner(PlaneMesh& mesh, const SimplifyParams& params);

} // namespace quoin
