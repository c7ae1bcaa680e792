#include "synth/room.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace quoin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kSamePlace = 1e-6; // [m]

std::vector<Polygon> subtract(std::vector<Polygon> pieces, const std::vector<Polygon>& holes, const Vector3d& normal)
{
    for (const Polygon& hole : holes) {
        std::vector<Polygon> left;
        for (const Polygon& piece : pieces)
            for (Polygon& rest : cut_polygon(piece, hole, normal).rest)
                left.push_back(std::move(rest));
        pieces = std::move(left);
    }
    return pieces;
}

bool lie_against(const Plane& a, const Plane& b)
{
    return (a.normal + b.normal).norm() < kSamePlace && std::abs(a.offset + b.offset) < kSamePlace;
}

bool lie_together(const Plane& a, const Plane& b)
{
    return (a.normal - b.normal).norm() < kSamePlace && std::abs(a.offset - b.offset) < kSamePlace;
}

// Do two edges share more than a point?
bool edges_touch(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d)
{
    const Vector3d along = (b - a).normalized();
    const auto off_line = [&](const Vector3d& p) { return ((p - a) - along * along.dot(p - a)).norm(); };
    if (off_line(c) > kSamePlace || off_line(d) > kSamePlace) return false;
    const double tc = along.dot(c - a), td = along.dot(d - a), length = (b - a).norm();
    return std::min(length, std::max(tc, td)) - std::max(0.0, std::min(tc, td)) > kSamePlace;
}

bool polygons_touch(const Polygon& a, const Polygon& b)
{
    for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t j = 0; j < b.size(); ++j)
            if (edges_touch(a[i], a[(i + 1) % a.size()], b[j], b[(j + 1) % b.size()])) return true;
    return false;
}

bool surfaces_touch(const PlanarSurface& a, const PlanarSurface& b)
{
    return std::any_of(a.pieces.begin(), a.pieces.end(), [&](const Polygon& p) {
        return std::any_of(b.pieces.begin(), b.pieces.end(), [&](const Polygon& q) { return polygons_touch(p, q); });
    });
}

void append(PlanarSurface& target, const PlanarSurface& added)
{
    target.pieces.insert(target.pieces.end(), added.pieces.begin(), added.pieces.end());
    for (Decal decal : added.finish.decals) {
        decal.corner += target.uv(added.origin);
        target.finish.decals.push_back(std::move(decal));
    }
}

// Right and down as who stands in front of the face sees them.
void set_texture_frame(PlanarSurface& face, const Vector3d& right)
{
    const Vector3d& n = face.plane.normal;
    const Vector3d upright = Vector3d::UnitZ().cross(n);
    face.right = right.isZero() ? upright.normalized() : right;
    face.down = face.right.cross(n);
    Vector2d low = face.uv(face.pieces[0][0]);
    for (const Vector3d& p : face.pieces[0])
        low = low.cwiseMin(face.uv(p));
    face.origin = face.at(low);
}

struct BoxFace {
    Side side;
    std::array<int, 4> corners; // bit 0: high x, bit 1: high y, bit 2: high z
};
constexpr std::array<BoxFace, 6> kBoxFaces{{{Side::Front, {2, 6, 7, 3}},
                                            {Side::Back, {0, 1, 5, 4}},
                                            {Side::Left, {1, 3, 7, 5}},
                                            {Side::Right, {0, 4, 6, 2}},
                                            {Side::Top, {4, 5, 7, 6}},
                                            {Side::Bottom, {0, 2, 3, 1}}}};

} // namespace

double LatheSurface::largest_radius() const
{
    double radius = 0.0;
    for (const Vector2d& p : profile)
        radius = std::max(radius, p.x());
    return radius;
}

std::vector<double> LatheSurface::profile_length() const
{
    std::vector<double> length{0.0};
    for (std::size_t i = 1; i < profile.size(); ++i)
        length.push_back(length.back() + (profile[i] - profile[i - 1]).norm());
    return length;
}

Vector3d LatheSurface::corner(int segment, std::size_t ring) const
{
    const double angle = 2.0 * std::numbers::pi * (segment % segments) / segments;
    const double radius = profile[ring].x();
    return foot + Vector3d(radius * std::cos(angle), radius * std::sin(angle), profile[ring].y());
}

Vector2d LatheSurface::corner_uv(int segment, std::size_t ring) const
{
    return {2.0 * std::numbers::pi * largest_radius() * segment / segments, profile_length()[ring]};
}

void RoomBuilder::begin_object(std::string name, const Rigid& world_from_object)
{
    name_ = std::move(name);
    world_from_object_ = world_from_object;
    ++object_;
}

std::size_t RoomBuilder::add_face(const Polygon& polygon, const Finish& finish, const Vector3d& right)
{
    PlanarSurface face;
    face.name = name_;
    face.object = object_;
    face.plane.normal = (polygon[1] - polygon[0]).cross(polygon[2] - polygon[1]).normalized();
    face.plane.offset = -face.plane.normal.dot(polygon[0]);
    face.pieces = {polygon};
    face.finish = finish;
    face.origin = polygon[0];
    set_texture_frame(face, right);
    make_contact(face);
    return join(std::move(face));
}

void RoomBuilder::add_box(const Box& box, const Material& material, const std::vector<SideDecal>& decals)
{
    for (const BoxFace& face : kBoxFaces) {
        Polygon polygon;
        for (const int bits : face.corners) {
            const Vector3d p(bits & 1 ? box.high.x() : box.low.x(), bits & 2 ? box.high.y() : box.low.y(),
                             bits & 4 ? box.high.z() : box.low.z());
            polygon.push_back(world_from_object_ * p);
        }
        Finish finish{material, {}};
        for (const SideDecal& decal : decals)
            if (decal.side == face.side) finish.decals.push_back(decal.decal);
        const bool level = face.side == Side::Top || face.side == Side::Bottom;
        add_face(polygon, finish, level ? Vector3d(-world_from_object_.linear().col(0)) : Vector3d::Zero());
    }
}

void RoomBuilder::add_lathe(const Vector3d& foot, std::vector<Vector2d> profile, const Finish& finish)
{
    LatheSurface lathe;
    lathe.name = name_;
    lathe.foot = world_from_object_ * foot;
    lathe.profile = std::move(profile);
    lathe.finish = finish;
    Polygon base;
    for (int s = 0; s < lathe.segments; ++s)
        base.push_back(lathe.corner(s, lathe.profile.size() - 1));
    const Plane under{-Vector3d::UnitZ(), lathe.foot.z()};
    if (lathe.profile.back().x() > kSamePlace)
        for (PlanarSurface& face : room_.planar)
            if (lie_against(face.plane, under))
                face.pieces = subtract(std::move(face.pieces), {base}, face.plane.normal);
    room_.curved.push_back(std::move(lathe));
}

void RoomBuilder::cut_hole(std::size_t face, const Polygon& hole)
{
    PlanarSurface& surface = room_.planar[face];
    surface.pieces = subtract(std::move(surface.pieces), {hole}, surface.plane.normal);
}

void RoomBuilder::make_contact(PlanarSurface& added)
{
    for (PlanarSurface& face : room_.planar) {
        if (!lie_against(face.plane, added.plane)) continue;
        const std::vector<Polygon> before = added.pieces;
        added.pieces = subtract(std::move(added.pieces), face.pieces, added.plane.normal);
        face.pieces = subtract(std::move(face.pieces), before, face.plane.normal);
    }
}

std::size_t RoomBuilder::join(PlanarSurface added)
{
    std::size_t home = room_.planar.size();
    for (std::size_t i = 0; i < room_.planar.size(); ++i) {
        PlanarSurface& face = room_.planar[i];
        const PlanarSurface& joined = home < room_.planar.size() ? room_.planar[home] : added;
        if (i == home || face.object != object_ || !lie_together(face.plane, added.plane) ||
            !surfaces_touch(face, joined))
            continue;
        if (home == room_.planar.size()) {
            append(face, added);
            home = i;
        } else {
            append(room_.planar[home], face);
            face.pieces.clear();
        }
    }
    if (home == room_.planar.size()) room_.planar.push_back(std::move(added));
    return home;
}

Room RoomBuilder::take()
{
    std::erase_if(room_.planar, [](const PlanarSurface& s) { return s.pieces.empty(); });
    return std::move(room_);
}

} // namespace quoin
