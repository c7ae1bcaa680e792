#include "simplify/simplify.h"

#include "base/error.h"
#include "base/log.h"
#include "simplify/clean.h"
#include "simplify/contract.h"
#include "simplify/remesh.h"
#include "simplify/snap.h"
#include "simplify/unfold.h"

#include <fmt/format.h>

namespace quoin {
namespace {

SimplifyParams relaxed(SimplifyParams params)
{
    params.max_error *= 2.0;
    params.max_open_error *= 2.0;
    params.max_inner_error *= 2.0;
    params.max_border_shift *= 2.0;
    return params;
}

// Straight creases and flat planes first, so that contractions find nothing to round off.
PlaneMesh by_quadrics(PlaneMesh mesh, const SimplifyParams& params)
{
    if (params.snap_distance > 0.0) snap_to_planes(mesh, params);
    Curves curves = trace_curves(mesh);
    contract(mesh, curves, params);
    return mesh;
}

PlaneMesh by_method(const PlaneMesh& mesh, const SimplifyParams& params)
{
    return params.method == SimplifyMethod::Qem ? by_quadrics(mesh, params) : remesh(mesh, params);
}

// Doubles the errors until the faces fit the budget, or nothing is left that larger errors would take away.
PlaneMesh within_budget(const PlaneMesh& mesh, SimplifyParams params)
{
    constexpr int kDoublings = 10;
    PlaneMesh result = by_method(mesh, params);
    if (params.face_budget == 0) return result;
    const auto budget = static_cast<std::size_t>(params.face_budget);
    for (int i = 0; i < kDoublings && result.mesh.face.size() > budget; ++i) {
        params = relaxed(params);
        result = by_method(mesh, params);
    }
    if (result.mesh.face.size() > budget)
        log_warning(fmt::format("{} faces are left of a budget of {}: planes keep at least a face each, corners stay",
                                result.mesh.face.size(), budget));
    return result;
}

} // namespace

PlaneMesh simplify(const PlaneMesh& mesh, const SimplifyParams& params)
{
    PlaneMesh result = mesh;
    clean_input(result, params);
    if (result.mesh.face.empty())
        throw ImpossibleError("the mesh has no face with three finite vertices; check the mesh that partition read");
    if (params.snap_distance > 0.0) trim_ears(result, params);
    result.vertex_class = classify_vertices(result.mesh, result.face_plane);
    result = within_budget(result, params);
    finish(result, params, PlaneParts::Joined);
    unfold(result, params);
    finish(result, params, PlaneParts::OneSided);
    log_info(fmt::format("{} faces in {} planes are left of {}", result.mesh.face.size(), result.plane.size(),
                         mesh.mesh.face.size()));
    return result;
}

} // namespace quoin
