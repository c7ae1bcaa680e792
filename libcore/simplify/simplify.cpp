#include "simplify/simplify.h"

#include "base/error.h"
#include "base/log.h"
#include "mesh/invariants.h"
#include "simplify/clean.h"
#include "simplify/contract.h"
#include "simplify/remesh.h"
#include "simplify/snap.h"
#include "simplify/unfold.h"

#include <cassert>
#include <fmt/format.h>

namespace quoin {
namespace {

using Opposites = std::vector<std::uint32_t>; // of half-edges

SimplifyParams relaxed(SimplifyParams params)
{
    params.max_error *= 2.0;
    params.max_open_error *= 2.0;
    params.max_inner_error *= 2.0;
    params.max_border_shift *= 2.0;
    return params;
}

// Straight creases and flat planes first, so that contractions find nothing to round off.
PlaneMesh by_quadrics(PlaneMesh mesh, const Opposites& opposite, const SimplifyParams& params)
{
    mesh.vertex_class = classify_vertices(mesh.mesh, mesh.face_plane, opposite);
    if (params.snap_distance > 0.0) snap_to_planes(mesh, params);
    Curves curves = trace_curves(mesh, opposite, border_half_edges(mesh, opposite));
    contract(mesh, curves, params);
    return mesh;
}

PlaneMesh by_method(PlaneMesh mesh, Opposites opposite, const SimplifyParams& params)
{
    return params.method == SimplifyMethod::Qem ? by_quadrics(std::move(mesh), opposite, params)
                                                : remesh(std::move(mesh), std::move(opposite), params);
}

// Doubles the errors until the faces fit the budget, or nothing is left that larger errors would take away.
PlaneMesh within_budget(PlaneMesh mesh, Opposites opposite, SimplifyParams params)
{
    constexpr int kDoublings = 10;
    if (params.face_budget == 0) return by_method(std::move(mesh), std::move(opposite), params);
    PlaneMesh result = by_method(mesh, opposite, params);
    const auto budget = static_cast<std::size_t>(params.face_budget);
    for (int i = 0; i < kDoublings && result.mesh.face.size() > budget; ++i) {
        params = relaxed(params);
        result = by_method(mesh, opposite, params);
    }
    if (result.mesh.face.size() > budget)
        log_warning(fmt::format("{} faces are left of a budget of {}: planes keep at least a face each, corners stay",
                                result.mesh.face.size(), budget));
    return result;
}

} // namespace

PlaneMesh simplify(PlaneMesh mesh, const SimplifyParams& params)
{
    const std::size_t dense_faces = mesh.mesh.face.size();
    Opposites opposite = clean_input(mesh, params);
    if (mesh.mesh.face.empty())
        throw ImpossibleError("the mesh has no face with three finite vertices; check the mesh that partition read");
    if (params.snap_distance > 0.0) trim_ears(mesh, opposite, params);
    PlaneMesh result = within_budget(std::move(mesh), std::move(opposite), params);
    finish(result, params, PlaneParts::Joined);
    unfold(result, params);
    finish(result, params, PlaneParts::OneSided);
    assert(broken_promise_of_light_mesh(result).empty());
    log_info(
        fmt::format("{} faces in {} planes are left of {}", result.mesh.face.size(), result.plane.size(), dense_faces));
    return result;
}

} // namespace quoin
