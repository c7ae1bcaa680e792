// Knots: spots where the border of a plane cannot be laid flat, cut out so that the rest of the plane can.
#pragma once

#include "mesh/plane_mesh.h"
#include "simplify/curves.h"
#include "simplify/simplify.h"

#include <cstdint>
#include <vector>

namespace quoin {

// The planes of a dense mesh come apart into connected zones: the largest piece of each plane, under the plane's own
// id; smaller pieces, and the knots cut out of them, under ids behind those of all planes. Zones are what is
// simplified, each by itself; in the end they are planes again.
class Zones {
public:
    explicit Zones(PlaneMesh mesh);

    std::size_t size() const { return mesh_.plane.size(); }
    // Has the zone been given up, to keep its shape? Knots are from the start.
    bool rough(PlaneId zone) const { return rough_[zone] != 0; }
    const Plane& plane(PlaneId zone) const { return mesh_.plane[zone]; }
    const Moments& moments(PlaneId zone) const { return mesh_.moments[zone]; }
    Curves curves() const { return trace_curves(mesh_, opposite_, border_); }

    // The faces of the zones that are not flat, one a zone, and the vertices of these and of all borders, named anew in
    // their old order; `curves` get the new names.
    PlaneMesh rough_part(const std::vector<std::uint8_t>& flat, Curves& curves) const;

    // What was found in one attempt to lay a zone flat.
    struct Failure {
        PlaneId zone = 0;
        std::vector<Eigen::Vector3d> knot; // where its border crosses or contradicts itself [m]; none: in other ways
    };
    // Cuts the faces around the knots out of their zones, farther around with every failure of a zone. Zones without
    // knots, or that little would be left of, or that have failed several times become rough.
    void cut(const std::vector<Failure>& failures, const SimplifyParams& params);

    // Puts the faces of a mesh with these zones into their planes again.
    void join(PlaneMesh& mesh) const;

private:
    struct Cut;
    std::vector<Cut> plan(const std::vector<Failure>& failures, const SimplifyParams& params);
    PlaneId add_zone(PlaneId from);
    void separate(const std::vector<std::uint8_t>& zones);
    void find_borders();

    PlaneMesh mesh_;
    const std::vector<std::uint32_t> opposite_;
    std::vector<std::uint32_t> border_; // half-edges, ascending
    std::vector<PlaneId> plane_of_;     // one a zone
    std::vector<std::uint8_t> failed_;  // times, one a zone
    std::vector<std::uint8_t> rough_;   // one a zone
};

} // namespace quoin
