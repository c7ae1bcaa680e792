#include "simplify/contract.h"

#include "simplify/borders.h"
#include "simplify/inner.h"

namespace quoin {

void contract(PlaneMesh& mesh, Curves& curves, const SimplifyParams& params)
{
    constexpr int kRounds = 4;
    for (int round = 0; round < kRounds; ++round) {
        simplify_inner(mesh, params);
        if (simplify_borders(mesh, curves, params) == 0) return;
    }
    simplify_inner(mesh, params);
}

} // namespace quoin
