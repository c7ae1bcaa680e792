#include "synth/furnish.h"

#include "synth/furniture.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace quoin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kClearance = 0.05; // between pieces [m]
constexpr int kTries = 60;          // at placing a piece

struct Rectangle {
    Vector2d low, high;
    bool overlaps(const Rectangle& other, double margin) const
    {
        return (low.array() - margin < other.high.array()).all() && (other.low.array() - margin < high.array()).all();
    }
};

// One of the four walls; object coordinates with the origin at the middle of its foot.
struct Wall {
    Rigid world_from_wall;
    double width = 0.0;
    std::size_t face = 0;
    std::vector<Rectangle> used; // (x, z)
};

struct Layout {
    std::array<Wall, 4> walls;
    std::size_t floor = 0;
    std::vector<Rectangle> floor_used; // world (x, y)
};

Rigid wall_frame(const Vector3d& size, int k)
{
    constexpr std::array<std::array<double, 2>, 4> inward{{{0, 1}, {-1, 0}, {0, -1}, {1, 0}}};
    const Vector3d y(inward[static_cast<std::size_t>(k)][0], inward[static_cast<std::size_t>(k)][1], 0.0),
        z = Vector3d::UnitZ();
    Rigid frame = Rigid::Identity();
    frame.linear().col(0) = y.cross(z);
    frame.linear().col(1) = y;
    frame.linear().col(2) = z;
    frame.translation() = -0.5 * y.cwiseProduct(size);
    return frame;
}

// Counter-clockwise seen from inside the room; x runs to the viewer's left.
Polygon wall_rectangle(const Rigid& world_from_wall, const Rectangle& r, double y)
{
    return {world_from_wall * Vector3d(r.high.x(), y, r.low.y()), world_from_wall * Vector3d(r.low.x(), y, r.low.y()),
            world_from_wall * Vector3d(r.low.x(), y, r.high.y()),
            world_from_wall * Vector3d(r.high.x(), y, r.high.y())};
}

Material wall_material(CounterRandom& random)
{
    constexpr std::array patterns{Pattern::Wallpaper, Pattern::Plaster, Pattern::Brick, Pattern::Plaster};
    const Pattern pattern = patterns[random.below(patterns.size())];
    const auto seed = static_cast<std::uint32_t>(random.bits());
    if (pattern == Pattern::Brick) return {pattern, {0.66f, 0.42f, 0.33f}, {0.74f, 0.71f, 0.66f}, seed};
    const Vector3f paint = any_tint(random, 0.74);
    return {pattern, paint, pattern == Pattern::Plaster ? Vector3f(paint * 0.75f) : any_tint(random, 0.5), seed};
}

void build_shell(RoomBuilder& builder, Layout& layout, const Vector3d& size, CounterRandom& random)
{
    const Vector3d h = 0.5 * size;
    const auto seed = static_cast<std::uint32_t>(random.bits());
    const Material floor = random.uniform() < 0.6
                               ? Material{Pattern::Planks, {0.68f, 0.50f, 0.33f}, {0.46f, 0.32f, 0.20f}, seed}
                               : Material{Pattern::Tiles, any_tint(random, 0.62), {0.42f, 0.42f, 0.42f}, seed};
    const Material ceiling{Pattern::Plaster, {0.80f, 0.80f, 0.77f}, {0.62f, 0.62f, 0.60f}, seed + 1};
    builder.begin_object("floor", Rigid::Identity());
    layout.floor = builder.add_face({{-h.x(), -h.y(), 0}, {h.x(), -h.y(), 0}, {h.x(), h.y(), 0}, {-h.x(), h.y(), 0}},
                                    {floor, {}}, Vector3d::UnitX());
    builder.begin_object("ceiling", Rigid::Identity());
    builder.add_face(
        {{-h.x(), -h.y(), size.z()}, {-h.x(), h.y(), size.z()}, {h.x(), h.y(), size.z()}, {h.x(), -h.y(), size.z()}},
        {ceiling, {}}, Vector3d::UnitX());
    for (int k = 0; k < 4; ++k) {
        Wall& wall = layout.walls[static_cast<std::size_t>(k)];
        wall.world_from_wall = wall_frame(size, k);
        wall.width = k % 2 == 0 ? size.x() : size.y();
        builder.begin_object("wall", wall.world_from_wall);
        wall.face = builder.add_face(
            wall_rectangle(wall.world_from_wall, {{-0.5 * wall.width, 0.0}, {0.5 * wall.width, size.z()}}, 0.0),
            {wall_material(random), {}});
    }
}

struct Recess {
    std::string name;
    Rectangle hole; // on the wall (x, z)
    double depth;   // [m]
    Finish back;
    Material reveal;
};

void build_recess(RoomBuilder& builder, Layout& layout, Wall& wall, const Recess& recess)
{
    const Rigid& frame = wall.world_from_wall;
    const Rectangle& r = recess.hole;
    builder.cut_hole(wall.face, wall_rectangle(frame, r, 0.0));
    const Polygon front = wall_rectangle(frame, r, 0.0), back = wall_rectangle(frame, r, -recess.depth);
    builder.begin_object(recess.name, frame);
    builder.add_face(back, recess.back);
    const Vector3d right = -frame.linear().col(0);
    for (std::size_t k = 0; k < 4; ++k) {
        const Polygon side{front[k], front[(k + 1) % 4], back[(k + 1) % 4], back[k]};
        const bool on_floor = k == 0 && r.low.y() == 0.0;
        if (on_floor)
            builder.extend(layout.floor, side);
        else
            builder.add_face(side, {recess.reveal, {}}, k % 2 == 0 ? right : Vector3d::Zero());
    }
    wall.used.push_back(r);
}

void build_door(RoomBuilder& builder, Layout& layout, Wall& wall, CounterRandom& random)
{
    const double x = random.uniform(-0.3, 0.3) * (wall.width - 1.2);
    const Vector3f paint = any_tint(random, 0.6);
    const Label number{"ROOM " + std::to_string(100 + random.below(300)), {30, 30, 60}, {225, 220, 200}};
    Finish panel{{Pattern::Wood, paint, paint * 0.75f, static_cast<std::uint32_t>(random.bits())}, {}};
    panel.decals.push_back({{0.20, 0.35}, {0.5, 0.14}, draw_label(number, {0.5, 0.14}, 0.001)});
    panel.decals.push_back({{0.06, 1.0}, {0.10, 0.10}, draw_label({"PULL"}, {0.10, 0.10}, 0.001)});
    const Material reveal{Pattern::Wood, paint * 1.15f, paint * 0.9f, static_cast<std::uint32_t>(random.bits())};
    build_recess(builder, layout, wall, {"door", {{x - 0.45, 0.0}, {x + 0.45, 2.0}}, 0.12, panel, reveal});
    const Vector3d a = wall.world_from_wall * Vector3d(x - 0.5, 0.0, 0.0),
                   b = wall.world_from_wall * Vector3d(x + 0.5, 0.9, 0.0);
    layout.floor_used.push_back({a.head<2>().cwiseMin(b.head<2>()), a.head<2>().cwiseMax(b.head<2>())});
}

void build_window(RoomBuilder& builder, Layout& layout, Wall& wall, CounterRandom& random)
{
    constexpr double width = 1.5, sill = 0.95, height = 1.1, depth = 0.20, bar = 0.05;
    const double x = random.uniform(-0.2, 0.2) * (wall.width - width);
    const Material view{
        Pattern::Sky, {0.62f, 0.76f, 0.92f}, {0.32f, 0.46f, 0.24f}, static_cast<std::uint32_t>(random.bits()), true};
    const Material reveal{
        Pattern::Plaster, {0.82f, 0.81f, 0.78f}, {0.6f, 0.6f, 0.6f}, static_cast<std::uint32_t>(random.bits())};
    const Rectangle hole{{x - 0.5 * width, sill}, {x + 0.5 * width, sill + height}};
    build_recess(builder, layout, wall, {"window", hole, depth, {view, {}}, reveal});
    const Material frame{Pattern::Wood, {0.80f, 0.78f, 0.74f}, {0.66f, 0.64f, 0.60f}, 3};
    builder.begin_object("window frame", wall.world_from_wall);
    builder.add_box({{x - 0.5 * bar, -depth, sill}, {x + 0.5 * bar, -depth + bar, sill + height}}, frame);
    builder.add_box(
        {{hole.low.x(), -depth, sill + 0.62 * height}, {x - 0.5 * bar, -depth + bar, sill + 0.62 * height + bar}},
        frame);
    builder.add_box(
        {{x + 0.5 * bar, -depth, sill + 0.62 * height}, {hole.high.x(), -depth + bar, sill + 0.62 * height + bar}},
        frame);
    const Rigid& f = wall.world_from_wall;
    builder.add_light({f * Vector3d(x, -depth + bar + 0.01, sill + 0.5 * height),
                       f.linear() * Vector3d(0.48 * width, 0, 0), Vector3d(0, 0, 0.48 * height), 1.0});
}

void build_ceiling_pieces(RoomBuilder& builder, const Vector3d& size, CounterRandom& random)
{
    builder.begin_object("beam", Rigid::Identity());
    const double y = random.uniform(0.12, 0.3) * size.y();
    const Material wood{
        Pattern::Wood, {0.50f, 0.36f, 0.24f}, {0.36f, 0.25f, 0.16f}, static_cast<std::uint32_t>(random.bits())};
    builder.add_box({{-0.5 * size.x(), y, size.z() - 0.16}, {0.5 * size.x(), y + 0.15, size.z()}}, wood);
    builder.begin_object("ceiling lamp", Rigid::Identity());
    const Material glow{Pattern::Paper, {0.88f, 0.87f, 0.82f}, {0.8f, 0.8f, 0.8f}, 1, true};
    builder.add_box({{-0.6, -0.75, size.z() - 0.07}, {0.6, -0.45, size.z()}}, glow);
    builder.add_light({{0.0, -0.6, size.z() - 0.08}, {0.55, 0, 0}, {0, 0.13, 0}, 1.6});
}

// A place along a wall where the piece collides with nothing.
bool place_piece(RoomBuilder& builder, Layout& layout, const Vector3d& size, Piece piece, CounterRandom& random)
{
    const Footprint f = footprint(piece, size.z());
    for (int attempt = 0; attempt < kTries; ++attempt) {
        Wall& wall = layout.walls[random.below(4)];
        const double reach = 0.5 * (wall.width - f.width) - kClearance;
        if (reach < 0.0) continue;
        const double x = random.uniform(-reach, reach);
        const Rectangle on_wall{{x - 0.5 * f.width, 0.0}, {x + 0.5 * f.width, f.height}};
        const Vector3d a = wall.world_from_wall * Vector3d(on_wall.low.x(), 0, 0),
                       b = wall.world_from_wall * Vector3d(on_wall.high.x(), f.depth, 0);
        const Rectangle on_floor{a.head<2>().cwiseMin(b.head<2>()), a.head<2>().cwiseMax(b.head<2>())};
        const auto hits = [&](const Rectangle& r, const std::vector<Rectangle>& used) {
            return std::any_of(used.begin(), used.end(), [&](const Rectangle& u) { return r.overlaps(u, kClearance); });
        };
        if (hits(on_floor, layout.floor_used) || hits(on_wall, wall.used)) continue;
        build_piece(builder, piece, f, wall.world_from_wall * Eigen::Translation3d(x, 0.0, 0.0), random);
        layout.floor_used.push_back(on_floor);
        wall.used.push_back(on_wall);
        return true;
    }
    return false;
}

void place_furniture(RoomBuilder& builder, Layout& layout, const SynthParams& params, CounterRandom& random)
{
    const Vector3d size(params.room_width, params.room_length, params.room_height);
    if (params.furniture > 0) {
        const Eigen::AngleAxisd turn(random.uniform(-0.5, 0.5), Vector3d::UnitZ());
        build_low_table(builder, Rigid(turn), random);
    }
    std::array<Piece, kPieces> order{};
    for (int i = 0; i < kPieces; ++i)
        order[static_cast<std::size_t>(i)] = static_cast<Piece>(i);
    for (std::uint32_t i = 3; i + 1 < kPieces; ++i)
        std::swap(order[i], order[i + random.below(kPieces - i)]);
    int placed = 1;
    for (std::size_t i = 0; placed < params.furniture && i < static_cast<std::size_t>(params.furniture) + kPieces; ++i)
        if (place_piece(builder, layout, size, order[i % kPieces], random)) ++placed;
}

void hang_pictures(RoomBuilder& builder, Layout& layout, const Vector3d& size, CounterRandom& random)
{
    for (Wall& wall : layout.walls)
        for (int attempt = 0; attempt < kTries; ++attempt) {
            const Vector2d extent(random.uniform(0.35, 0.75), random.uniform(0.40, 0.85));
            const double x = random.uniform(-0.5, 0.5) * (wall.width - extent.x() - 0.2),
                         z = random.uniform(0.5, size.z() - extent.y() - 0.35);
            const Rectangle place{{x - 0.5 * extent.x(), z}, {x + 0.5 * extent.x(), z + extent.y()}};
            const bool hits = std::any_of(wall.used.begin(), wall.used.end(),
                                          [&](const Rectangle& u) { return place.overlaps(u, 2 * kClearance); });
            if (hits || random.uniform() < 0.8) continue;
            build_picture(builder, wall.world_from_wall * Eigen::Translation3d(x, 0.0, z), extent, random);
            wall.used.push_back(place);
        }
}

} // namespace

Room furnish_room(const SynthParams& params)
{
    const Vector3d size(params.room_width, params.room_length, params.room_height);
    CounterRandom random(static_cast<std::uint64_t>(params.seed), RandomPurpose::Layout);
    RoomBuilder builder(size);
    Layout layout;
    build_shell(builder, layout, size, random);
    const std::uint32_t door_wall = random.below(4);
    build_door(builder, layout, layout.walls[door_wall], random);
    build_window(builder, layout, layout.walls[(door_wall + 1 + random.below(3)) % 4], random);
    build_ceiling_pieces(builder, size, random);
    place_furniture(builder, layout, params, random);
    if (params.furniture > 0) hang_pictures(builder, layout, size, random);
    return builder.take();
}

} // namespace quoin
