// Knots: spots where the border of a plane cannot be laid flat, cut out so that the rest of the plane can.
#pragma once

#include "mesh/plane_mesh.h"
#include "simplify/curves.h"
#include "simplify/simplify.h"

#include <cstdint>
#include <vector>

namespace quoin {

// What is to be simplified next: all vertices of borders of pending zones, and the faces of those that are rough.
struct ZonePart {
    PlaneMesh mesh;              // its planes are zones
    Curves curves;               // of pending zones
    std::vector<VertexId> dense; // of every vertex that of the dense mesh, ascending
};

// The planes of a dense mesh come apart into connected zones: the largest piece of each plane, under the plane's own
// id; smaller pieces, and the knots cut out of them, under ids behind those of all planes. Zones are what is
// simplified, each by itself; in the end they are planes again.
class Zones {
public:
    // opposite: of the half-edges.
    Zones(PlaneMesh mesh, std::vector<std::uint32_t> opposite);

    std::size_t size() const { return mesh_.plane.size(); }
    const PlaneMesh& mesh() const { return mesh_; } // its planes are zones
    const Plane& plane(PlaneId zone) const { return mesh_.plane[zone]; }
    const Moments& moments(PlaneId zone) const { return mesh_.moments[zone]; }

    // Is the zone to keep its shape, for its border cannot be laid flat? Knots are.
    bool rough(PlaneId zone) const { return rough_[zone] != 0; }
    void give_up(PlaneId zone) { rough_[zone] = 1; }
    std::size_t rough_count() const;
    // Is the zone to be simplified, or simplified again since a cut came near it?
    bool pending(PlaneId zone) const { return pending_[zone] != 0; }
    ZonePart part() const;

    // What was found in one attempt to lay a zone flat.
    struct Failure {
        PlaneId zone = 0;
        std::vector<Eigen::Vector3d> knot; // where its border crosses or contradicts itself [m]; none: in other ways
    };
    // Cuts the faces around the knots out of their zones, farther around with every failure of a zone. Zones without
    // knots, or that little would be left of, or that have failed many times become rough. These zones and those beside
    // the knots are pending now; so are those that touch rough ones, which do not keep to borders that are settled.
    void cut(const std::vector<Failure>& failures, const SimplifyParams& params);

    // Puts the faces of a mesh with these zones into their planes again.
    void join(PlaneMesh& mesh) const;

private:
    struct Cut;
    std::vector<Cut> plan(const std::vector<Failure>& failures, const SimplifyParams& params);
    PlaneId add_zone(PlaneId from);
    void separate(const std::vector<FaceId>& faces, std::vector<FaceId>& relabelled);
    void add_borders(const std::vector<FaceId>& relabelled);
    void classify_ends(const std::vector<std::uint32_t>& border);
    std::array<VertexId, 2> ends(std::uint32_t half_edge) const
    {
        const Face& face = mesh_.mesh.face[half_edge / 3];
        return {face[half_edge % 3], face[(half_edge % 3 + 1) % 3]};
    }
    template <class Visit>
    void for_each_side(const Visit& visit) const;
    void spread_pending();

    PlaneMesh mesh_;
    const std::vector<std::uint32_t> opposite_;
    std::vector<std::uint32_t> border_; // half-edges, ascending
    std::vector<PlaneId> plane_of_;     // one a zone
    std::vector<std::uint8_t> failed_;  // times, one a zone
    std::vector<std::uint8_t> rough_;   // one a zone
    std::vector<std::uint8_t> pending_; // one a zone
    std::vector<std::uint32_t> index_;  // F; scratch
};

} // namespace quoin
