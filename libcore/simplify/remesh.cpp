#include "simplify/remesh.h"

#include "base/log.h"
#include "mesh/cleanup.h"
#include "simplify/remesher.h"
#include "simplify/stitch.h"

#include <algorithm>
#include <fmt/format.h>

namespace quoin {
namespace {

void give_up_bent_zones(Zones& zones, const SimplifyParams& params)
{
    for (PlaneId z = 0; z < zones.size(); ++z)
        if (params.max_inner_error > 0.0 && rms_to_plane(zones.moments(z), zones.plane(z)) > params.max_inner_error)
            zones.give_up(z);
    for (const Curve& curve : zones.part().curves.curve)
        for (std::size_t k = 0; k < 2; ++k)
            if (curve.planes[k] != kNoPlane && curve.runs[k] == 0) zones.give_up(curve.planes[k]);
}

PlaneMesh joined(const Zones& zones, const Settled& settled)
{
    PlaneMesh mesh;
    mesh.plane = zones.mesh().plane;
    mesh.moments = zones.mesh().moments;
    mesh.mesh.position = settled.position;
    mesh.mesh.color = zones.mesh().mesh.color;
    for (PlaneId z = 0; z < settled.face.size(); ++z) {
        mesh.mesh.face.insert(mesh.mesh.face.end(), settled.face[z].begin(), settled.face[z].end());
        mesh.face_plane.insert(mesh.face_plane.end(), settled.face[z].size(), z);
    }
    remove_isolated_vertices(mesh.mesh);
    split_shared_chords(mesh);
    zones.join(mesh);
    return mesh;
}

} // namespace

PlaneMesh remesh(PlaneMesh mesh, std::vector<std::uint32_t> opposite, const SimplifyParams& params)
{
    Zones zones(std::move(mesh), std::move(opposite));
    give_up_bent_zones(zones, params);
    const std::size_t vertices = zones.mesh().mesh.position.size();
    Settled settled{zones.mesh().mesh.position, std::vector<std::uint8_t>(vertices, 0), {}};
    while (true) { // in every turn flat zones lose faces, or are given up; without any this is the method qem
        Remesher remesher(zones, zones.part(), settled, params);
        const bool done = remesher.run();
        remesher.settle(settled);
        if (done) break;
        zones.cut(remesher.failures(), params);
        for (PlaneId z = 0; z < settled.face.size(); ++z)
            if (zones.pending(z)) settled.face[z].clear();
    }
    log_info(fmt::format("{} pieces of planes are filled anew, {} pieces and knots keep their shape",
                         zones.size() - zones.rough_count(), zones.rough_count()));
    return joined(zones, settled);
}

} // namespace quoin
