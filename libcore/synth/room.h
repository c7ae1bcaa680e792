// A room as the surfaces that can be seen: planar ones, convex piece by convex piece, and surfaces of revolution.
#pragma once

#include "geometry/plane.h"
#include "geometry/rigid.h"
#include "synth/material.h"
#include "synth/polygon.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace quoin {

struct Finish {
    Material material;
    std::vector<Decal> decals;
};

// One plane of the room. Its texture frame is upright for who looks at it: uv = (right, down) . (p_world - origin) [m].
struct PlanarSurface {
    std::string name; // of the object it belongs to
    std::uint32_t object = 0;
    Plane plane; // normal towards the free side
    Eigen::Vector3d origin, right, down;
    std::vector<Polygon> pieces; // without overlap, counter-clockwise seen from the free side
    Finish finish;

    Eigen::Vector2d uv(const Eigen::Vector3d& p_world) const
    {
        return {right.dot(p_world - origin), down.dot(p_world - origin)};
    }
    Eigen::Vector3d at(const Eigen::Vector2d& uv) const { return origin + uv.x() * right + uv.y() * down; }
};

// A faceted surface of revolution about a vertical axis. uv: along the circle of the largest radius, and along the
// profile [m].
struct LatheSurface {
    std::string name;
    Eigen::Vector3d foot;                 // height 0 on the axis
    std::vector<Eigen::Vector2d> profile; // (radius, height) [m]; the free side is on the left of its direction
    int segments = 48;
    Finish finish;

    double largest_radius() const;
    std::vector<double> profile_length() const; // up to every profile point [m]
    Eigen::Vector3d corner(int segment, std::size_t ring) const;
    Eigen::Vector2d corner_uv(int segment, std::size_t ring) const;
};

// A rectangle that lights the room.
struct AreaLight {
    Eigen::Vector3d center, half_u, half_v; // world [m]
    double strength = 1.0;
};

struct Room {
    Eigen::Vector3d size;              // x, y, z [m]; the floor's centre is the origin, z is up
    std::vector<PlanarSurface> planar; // index = PlaneId
    std::vector<LatheSurface> curved;
    std::vector<AreaLight> lights;
};

// The six sides of a box as its object sees them: y towards the viewer, z up, x to the viewer's left.
enum class Side : std::uint8_t { Front, Back, Left, Right, Top, Bottom };
struct SideDecal {
    Side side;
    Decal decal; // corner relative to the upper left of the side
};

struct Box {
    Eigen::Vector3d low, high; // object coordinates [m]
};

// Puts solids into a room. Where a new face lies against an older one, what is hidden of both disappears; faces of one
// object that lie in one plane and touch become one plane.
class RoomBuilder {
public:
    explicit RoomBuilder(const Eigen::Vector3d& size) { room_.size = size; }
    void begin_object(std::string name, const Rigid& world_from_object);
    // A face of the current object; world coordinates, counter-clockwise from the free side. `right` points to the
    // right in its texture, or is zero for upright. Returns its number until take().
    std::size_t add_face(const Polygon& polygon, const Finish& finish,
                         const Eigen::Vector3d& right = Eigen::Vector3d::Zero());
    void add_box(const Box& box, const Material& material, const std::vector<SideDecal>& decals = {});
    // `foot` in object coordinates; its last profile point, at height 0, stands on what is below.
    void add_lathe(const Eigen::Vector3d& foot, std::vector<Eigen::Vector2d> profile, const Finish& finish);
    void cut_hole(std::size_t face, const Polygon& hole);
    void extend(std::size_t face, const Polygon& piece) { room_.planar[face].pieces.push_back(piece); }
    void add_light(const AreaLight& light) { room_.lights.push_back(light); }
    const Rigid& world_from_object() const { return world_from_object_; }
    Room take(); // without the surfaces that nothing is left of

private:
    void make_contact(PlanarSurface& added);
    std::size_t join(PlanarSurface added);

    Room room_;
    std::string name_;
    std::uint32_t object_ = 0;
    Rigid world_from_object_ = Rigid::Identity();
};

} // namespace quoin
