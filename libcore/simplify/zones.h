// Knots: spots where the border of a plane cannot be laid flat, cut out so that the rest of the plane can.
#pragma once

#include "mesh/plane_mesh.h"
#include "simplify/curves.h"
#include "simplify/simplify.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace quoin {

// What is to be simplified next: the borders of pending zones.
struct ZonePart {
    PlaneMesh mesh;                                  // without faces; its planes are zones
    Curves curves;                                   // of pending zones
    std::vector<VertexId> dense;                     // of every vertex that of the dense mesh, ascending
    std::vector<std::array<VertexId, 2>> rough_edge; // of faces of rough zones, between corners; low, high

    VertexId index(VertexId v) const
    {
        return static_cast<VertexId>(std::ranges::lower_bound(dense, v) - dense.begin());
    }
    bool has(VertexId v) const { return std::ranges::binary_search(dense, v); }
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

    // Zones within one other that lie as close to its plane as a vertex inside may, and are as small as a hole that is
    // filled, become part of it.
    void absorb_islands(const SimplifyParams& params);

    // Is the zone to keep its faces, for its border cannot be laid flat? Knots are.
    bool rough(PlaneId zone) const { return rough_[zone] != 0; }
    void give_up(PlaneId zone) { rough_[zone] = 1; }
    std::size_t rough_count() const;
    // Is the flat zone to be filled, or filled again since a cut came near it?
    bool pending(PlaneId zone) const { return pending_[zone] != 0; }
    ZonePart part() const; // without rough edges
    void add_rough_edges(ZonePart& part);

    // What was found in one attempt to lay a zone flat.
    struct Failure {
        PlaneId zone = 0;
        std::vector<Eigen::Vector3d> knot; // where its border crosses or contradicts itself [m]; none: in other ways
    };
    // Cuts the faces around the knots out of their zones, farther around where an earlier cut was not enough. Zones
    // without knots, or that little would be left of, or that have failed many times become rough. What is left of
    // these zones, and those that touch what became rough, are pending now.
    void cut(const std::vector<Failure>& failures, const SimplifyParams& params);

    // Puts the faces of a mesh with these zones into their planes again.
    void join(PlaneMesh& mesh) const;

private:
    struct Cut;
    void separate_pieces();
    PlaneId add_zone(PlaneId from);
    void note_edges(FaceId f);
    void note_rough_zones();
    std::array<VertexId, 2> ends(std::uint32_t half_edge) const
    {
        const Face& face = mesh_.mesh.face[half_edge / 3];
        return {face[half_edge % 3], face[(half_edge % 3 + 1) % 3]};
    }

    std::vector<PlaneId> surrounding_zones() const;
    void keep_small(std::vector<PlaneId>& surrounding, double diameter) const;
    void keep_low(std::vector<PlaneId>& surrounding, const std::vector<FaceId>& faces, double height) const;
    bool absorb(const std::vector<PlaneId>& surrounding, const std::vector<FaceId>& faces);

    std::vector<Cut> begin_cuts(const std::vector<Failure>& failures) const;
    std::array<std::vector<Eigen::Vector3d>, 2> sort_knots(const Cut& cut, double reach) const;
    void find_faces(Cut& cut, double reach, const std::vector<Eigen::Vector3d>& knots);
    void find_faces(Cut& cut, const SimplifyParams& params);
    void find_cut_off(Cut& cut);
    PlaneId take_out(const std::vector<FaceId>& faces);
    void take_out(const Cut& cut, std::vector<std::uint8_t>& stirred);
    void add_borders(const std::vector<FaceId>& relabelled);
    void classify_ends(const std::vector<std::uint32_t>& border);
    void spread_pending(const std::vector<std::uint8_t>& stirred);

    PlaneMesh mesh_;
    const std::vector<std::uint32_t> opposite_;
    std::vector<std::uint32_t> border_;               // half-edges, ascending
    std::vector<PlaneId> plane_of_;                   // one a zone
    std::vector<FaceId> faces_;                       // number of faces, one a zone
    std::vector<std::uint8_t> failed_;                // times, one a zone
    std::vector<std::uint8_t> rough_;                 // one a zone
    std::vector<std::uint8_t> pending_;               // one a zone
    std::vector<std::uint8_t> noted_;                 // one a zone: is it rough, and are its edges among rough_edge_?
    std::vector<std::array<VertexId, 2>> rough_edge_; // of faces of rough zones, between borders
    std::vector<std::uint32_t> mark_;                 // F; scratch, 0 in between
};

} // namespace quoin
