// One attempt to simplify the zones of a mesh that are not settled yet.
#pragma once

#include "simplify/outlines.h"
#include "simplify/zones.h"

namespace quoin {

// What has been simplified for good, in vertices of the dense mesh.
struct Settled {
    explicit Settled(const std::vector<Eigen::Vector3f>& dense) : position(dense), gone(dense.size(), 0) {}

    std::vector<Eigen::Vector3f> position; // V; of vertices that faces have
    std::vector<std::uint8_t> gone;        // V; is it a vertex of a curve that was joined to others?
    std::vector<std::vector<Face>> face;   // by zone, of flat ones
};

// The borders of the flat zones are thinned, and each is filled anew between them. What borders on rough zones stays as
// the dense mesh has it, what borders on settled ones as they have it.
class Remesher {
public:
    Remesher(const Zones& zones, ZonePart part, const Settled& settled, const SimplifyParams& params);

    // Have all zones been filled?
    bool run();
    std::vector<Zones::Failure> failures() const;
    // Adds the faces of the zones that have been simplified, and all borders as they are now.
    void settle(Settled& settled) const;

private:
    using Flags = std::vector<std::uint8_t>;
    using Edges = std::vector<std::array<VertexId, 2>>;
    struct BadSegment {
        PlaneOutline::Source source;
        std::uint8_t least_step = 0; // that is to be taken
    };

    void hold_settled(const Settled& settled);
    void straighten(const Settled& settled);
    void take_over(Curve& curve, const Settled& settled);
    void fill_holes();
    bool is_hole(CurveId id) const;
    bool is_small_hole(CurveId id) const;
    void bound_free_curves();
    void bound_edges();
    Edges taken_edges() const;
    double length(const Curve& curve) const;
    void thin_free_curves();
    void restore(CurveId id);
    std::vector<BadSegment> bad_segments(const PlaneOutline& plane) const;
    bool tighten(const Outlines& outlines, const Flags& changed);
    void tighten_segment(const BadSegment& bad);
    void release(std::uint32_t slot);
    void triangulate_planes();
    void triangulate_plane(const Outlines& outlines, PlaneId p);

    const ZonePart part_; // dense
    const SimplifyParams& params_;
    Flags flat_; // one a zone: to be filled
    Curves curves_;
    Flags fixed_; // one a curve: 0, or what holds it: settled zones or, before them, rough ones
    Flags held_;  // one a vertex: settled zones have it
    Edges settled_edges_;
    Flags filled_;                          // one a curve: borders of holes that vanish
    std::vector<Eigen::Vector3d> position_; // V
    CurveBounds bounds_;
    std::vector<std::uint8_t> step_;                               // one a slot: how often its bound was tightened
    std::vector<CurveId> free_;                                    // curves that are not fixed
    Flags dirty_;                                                  // one a curve: to be simplified again
    std::vector<std::pair<VertexId, std::uint32_t>> corner_slots_; // of all curves, sorted
    Flags released_;                                               // one a vertex: is where it was in the dense mesh
    std::vector<std::vector<Face>> faces_;                         // one a zone
    Flags failed_;                                                 // one a zone
    std::vector<std::vector<Eigen::Vector3d>> knots_;              // of zones that failed
};

} // namespace quoin
