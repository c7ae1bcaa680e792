#include "simplify/simplify.h"

#include "base/error.h"
#include "base/log.h"
#include "simplify/borders.h"
#include "simplify/clean.h"
#include "simplify/inner.h"
#include "simplify/snap.h"

#include <fmt/format.h>

namespace quoin {
namespace {

// Straight creases and flat planes first, so that contractions find nothing to round off.
void straighten(PlaneMesh& mesh, const SimplifyParams& params)
{
    if (params.snap_distance <= 0.0) return;
    trim_ears(mesh, params);
    mesh.vertex_class = classify_vertices(mesh.mesh, mesh.face_plane);
    snap_to_planes(mesh, params);
}

// Planes and borders in turn: fewer vertices on one side make room for contractions on the other.
void contract(PlaneMesh& mesh, Curves& curves, const SimplifyParams& params)
{
    constexpr int kRounds = 4;
    for (int round = 0; round < kRounds; ++round) {
        simplify_inner(mesh, params);
        if (simplify_borders(mesh, curves, params) == 0) return;
    }
    simplify_inner(mesh, params);
}

// Doubles the errors until the faces fit the budget, or nothing is left that larger errors would take away.
void meet_budget(PlaneMesh& mesh, Curves& curves, const SimplifyParams& params)
{
    constexpr int kDoublings = 10;
    SimplifyParams relaxed = params;
    const auto budget = static_cast<std::size_t>(params.face_budget);
    for (int i = 0; i < kDoublings && params.face_budget > 0 && mesh.mesh.face.size() > budget; ++i) {
        relaxed.max_error *= 2.0;
        relaxed.max_open_error *= 2.0;
        relaxed.max_inner_error *= 2.0;
        relaxed.max_border_shift *= 2.0;
        contract(mesh, curves, relaxed);
    }
    if (params.face_budget > 0 && mesh.mesh.face.size() > budget)
        log_warning(fmt::format("{} faces are left of a budget of {}: planes keep at least a face each, corners stay",
                                mesh.mesh.face.size(), budget));
}

} // namespace

PlaneMesh simplify(const PlaneMesh& mesh, const SimplifyParams& params)
{
    PlaneMesh result = mesh;
    clean_input(result, params);
    if (result.mesh.face.empty())
        throw ImpossibleError("the mesh has no face with three finite vertices; check the mesh that partition read");
    straighten(result, params);
    Curves curves = trace_curves(result);
    contract(result, curves, params);
    meet_budget(result, curves, params);
    finish(result);
    log_info(fmt::format("{} faces in {} planes are left of {}", result.mesh.face.size(), result.plane.size(),
                         mesh.mesh.face.size()));
    return result;
}

} // namespace quoin
