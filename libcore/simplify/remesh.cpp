#include "simplify/remesh.h"

#include "base/log.h"
#include "geometry/groups.h"
#include "mesh/adjacency.h"
#include "mesh/cleanup.h"
#include "simplify/contract.h"
#include "simplify/inner.h"
#include "simplify/remesher.h"
#include "simplify/snap.h"
#include "simplify/stitch.h"

#include <algorithm>
#include <fmt/format.h>

namespace quoin {
namespace {

// Those too far from their planes, and those whose borders run both ways.
void give_up_bent_zones(Zones& zones, const Curves& borders, const SimplifyParams& params)
{
    for (PlaneId z = 0; z < zones.size(); ++z)
        if (params.max_inner_error > 0.0 && rms_to_plane(zones.moments(z), zones.plane(z)) > params.max_inner_error)
            zones.give_up(z);
    for (const Curve& curve : borders.curve)
        for (std::size_t k = 0; k < 2; ++k)
            if (curve.planes[k] != kNoPlane && curve.runs[k] == 0) zones.give_up(curve.planes[k]);
}

// Flat zones as they were filled, rough ones as the dense mesh has them.
PlaneMesh zone_mesh(const Zones& zones, const Settled& settled)
{
    PlaneMesh mesh;
    mesh.plane = zones.mesh().plane;
    mesh.moments = zones.mesh().moments;
    mesh.mesh.position = zones.mesh().mesh.position;
    mesh.mesh.color = zones.mesh().mesh.color;
    const auto dense = group_items(zones.mesh().face_plane, zones.size());
    for (PlaneId z = 0; z < zones.size(); ++z) {
        auto& face = mesh.mesh.face;
        if (zones.rough(z)) {
            for (const FaceId f : dense.of(z))
                face.push_back(zones.mesh().mesh.face[f]);
        } else
            for (const Face& filled : settled.face[z]) {
                face.push_back(filled);
                for (const VertexId v : filled)
                    mesh.mesh.position[v] = settled.position[v];
            }
        mesh.face_plane.resize(face.size(), z);
    }
    remove_isolated_vertices(mesh.mesh);
    split_shared_chords(mesh);
    return mesh;
}

// Rough zones and their borders, with the flat zones around them, which they must not fold onto.
void contract_rough(PlaneMesh& mesh, const Zones& zones, const SimplifyParams& params)
{
    const auto opposite = opposite_half_edges(mesh.mesh);
    mesh.vertex_class = classify_vertices(mesh.mesh, mesh.face_plane, opposite);
    if (params.snap_distance > 0.0) snap_to_planes(mesh, params);
    Curves curves = trace_curves(mesh, opposite, border_half_edges(mesh, opposite));
    for (Curve& curve : curves.curve)
        curve.in_mesh = std::ranges::any_of(curve.planes, [&](PlaneId z) { return z != kNoPlane && zones.rough(z); });
    contract(mesh, curves, params);
}

// What was a border between zones of one plane lies inside it.
void contract_joints(PlaneMesh& mesh, const SimplifyParams& params)
{
    mesh.vertex_class = classify_vertices(mesh.mesh, mesh.face_plane);
    simplify_inner(mesh, params);
}

} // namespace

PlaneMesh remesh(PlaneMesh mesh, std::vector<std::uint32_t> opposite, const SimplifyParams& params)
{
    Zones zones(std::move(mesh), std::move(opposite));
    zones.absorb_islands(params);
    ZonePart part = zones.part();
    give_up_bent_zones(zones, part.curves, params);
    Settled settled(zones.mesh().mesh.position);
    while (true) { // in every turn flat zones lose faces, or are given up; without any this is the method qem
        zones.add_rough_edges(part);
        Remesher remesher(zones, std::move(part), settled, params);
        const bool done = remesher.run();
        remesher.settle(settled);
        if (done) break;
        zones.cut(remesher.failures(), params);
        for (PlaneId z = 0; z < settled.face.size(); ++z)
            if (zones.pending(z)) settled.face[z].clear();
        part = zones.part();
    }
    log_info(fmt::format("{} pieces of planes are filled anew, {} pieces and knots are contracted",
                         zones.size() - zones.rough_count(), zones.rough_count()));
    PlaneMesh light = zone_mesh(zones, settled);
    contract_rough(light, zones, params);
    zones.join(light);
    contract_joints(light, params);
    return light;
}

} // namespace quoin
