#include "synth/furniture.h"

#include <algorithm>
#include <array>

namespace quoin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kInkPixel = 0.001; // pictures and words are drawn with this [m] a pixel

std::uint32_t any_seed(CounterRandom& random) { return static_cast<std::uint32_t>(random.bits()); }

Material any_wood(CounterRandom& random)
{
    constexpr std::array<std::array<float, 3>, 4> tones{
        {{0.72f, 0.53f, 0.33f}, {0.55f, 0.37f, 0.22f}, {0.80f, 0.66f, 0.46f}, {0.62f, 0.45f, 0.34f}}};
    const auto& tone = tones[random.below(tones.size())];
    const Vector3f first(tone[0], tone[1], tone[2]);
    return {Pattern::Wood, first, first * 0.68f, any_seed(random)};
}

Material material(Pattern pattern, CounterRandom& random, double light)
{
    const Vector3f first = any_tint(random, light);
    return {pattern, first, any_tint(random, light * 0.55), any_seed(random)};
}

Decal label(const Label& text, const Vector2d& corner, const Vector2d& size)
{
    return {corner, size, draw_label(text, size, kInkPixel)};
}

Decal poster(CounterRandom& random, const Vector2d& corner, const Vector2d& size)
{
    const auto style = static_cast<PosterStyle>(random.below(kPosterStyles));
    return {corner, size, draw_poster(style, size, kInkPixel, any_seed(random))};
}

Rgb8 truncated_rgb8(const Vector3f& color)
{
    return {static_cast<std::uint8_t>(color.x() * 255), static_cast<std::uint8_t>(color.y() * 255),
            static_cast<std::uint8_t>(color.z() * 255)};
}

// A row of books between x = low.x and high_x standing on low.z against low.y.
void add_books(RoomBuilder& builder, const Vector3d& low, double high_x, double height, CounterRandom& random)
{
    constexpr std::array titles{"ALGEBRA", "TOPOLOGY", "MONUMENTS", "STONE AND ARCH", "COOKING",
                                "VOL. IV", "A ROOM",   "ATLAS",     "OPTICS",         "BIRDS"};
    for (double x = low.x(); x < high_x;) {
        const double thick = random.uniform(0.025, 0.06), tall = height * random.uniform(0.6, 0.92),
                     deep = random.uniform(0.15, 0.22);
        if (x + thick > high_x) break;
        if (random.uniform() < 0.85) {
            const Vector3f cover = any_tint(random, random.uniform(0.2, 0.8));
            const Label spine{
                titles[random.below(titles.size())], {240, 235, 220}, truncated_rgb8(cover * 0.8f), false};
            const SideDecal decal{Side::Front, label(spine, {0.003, 0.02}, {thick - 0.006, tall - 0.04})};
            builder.add_box({{x, low.y(), low.z()}, {x + thick, low.y() + deep, low.z() + tall}},
                            {Pattern::Paper, cover, cover, any_seed(random)}, {decal});
        }
        x += thick + (random.uniform() < 0.2 ? 0.03 : 0.0);
    }
}

void add_legs(RoomBuilder& builder, const Box& top, double leg, const Material& wood)
{
    for (const double x : {top.low.x() + 0.02, top.high.x() - 0.02 - leg})
        for (const double y : {top.low.y() + 0.02, top.high.y() - 0.02 - leg})
            builder.add_box({{x, y, 0.0}, {x + leg, y + leg, top.low.z()}}, wood);
}

void build_stairs(RoomBuilder& builder, const Footprint& f, CounterRandom& random)
{
    const Material wood = any_wood(random);
    constexpr int steps = 4;
    for (int i = 0; i < steps; ++i) {
        const double x0 = -0.5 * f.width + f.width * i / steps, x1 = -0.5 * f.width + f.width * (i + 1) / steps;
        builder.add_box({{x0, 0.0, 0.0}, {x1, f.depth, f.height * (i + 1) / steps}}, wood);
    }
}

void build_bookshelf(RoomBuilder& builder, const Footprint& f, CounterRandom& random)
{
    const Material wood = any_wood(random);
    constexpr double board = 0.025;
    constexpr int shelves = 5;
    const double x0 = -0.5 * f.width, x1 = 0.5 * f.width;
    builder.add_box({{x0, 0.0, 0.0}, {x0 + board, f.depth, f.height}}, wood);
    builder.add_box({{x1 - board, 0.0, 0.0}, {x1, f.depth, f.height}}, wood);
    builder.add_box({{x0 + board, 0.0, 0.0}, {x1 - board, 0.012, f.height}}, wood);
    std::vector<double> levels;
    for (int i = 0; i <= shelves; ++i) {
        const double z = (f.height - board) * i / shelves;
        builder.add_box({{x0 + board, 0.012, z}, {x1 - board, f.depth, z + board}}, wood);
        levels.push_back(z + board);
    }
    const Rigid frame = builder.world_from_object();
    for (int i = 0; i < shelves; ++i) {
        builder.begin_object("books", frame);
        const double end = x1 - board - random.uniform(0.02, 0.4 * f.width);
        add_books(builder, {x0 + board + 0.02, 0.012, levels[static_cast<std::size_t>(i)]}, end,
                  f.height / shelves - board, random);
    }
}

void build_desk(RoomBuilder& builder, const Footprint& f, CounterRandom& random)
{
    const Material wood = any_wood(random);
    const Box top{{-0.5 * f.width, 0.0, f.height - 0.04}, {0.5 * f.width, f.depth, f.height}};
    const double paper_x = random.uniform(0.1, 0.4) * f.width;
    builder.add_box(top, wood, {{Side::Top, poster(random, {paper_x, f.depth - 0.36}, {0.42, 0.30})}});
    add_legs(builder, top, 0.06, wood);
    const Rigid frame = builder.world_from_object();
    builder.begin_object("screen", frame);
    const Material shell = material(Pattern::Metal, random, 0.35);
    builder.add_box({{-0.26, 0.10, f.height}, {0.26, 0.16, f.height + 0.38}}, shell,
                    {{Side::Front, poster(random, {0.02, 0.02}, {0.48, 0.31})}});
    builder.begin_object("books", frame);
    add_books(builder, {0.30, 0.05, f.height}, 0.5 * f.width - 0.02, 0.28, random);
    builder.begin_object("mug", frame);
    const std::vector<Vector2d> mug{{0.0, 0.01}, {0.035, 0.01}, {0.035, 0.10}, {0.04, 0.10}, {0.04, 0.0}};
    builder.add_lathe({-0.40, 0.45, f.height}, mug, {material(Pattern::Tiles, random, 0.7), {}});
}

void build_wardrobe(RoomBuilder& builder, const Footprint& f, CounterRandom& random)
{
    const Material wood = any_wood(random);
    builder.add_box({{-0.5 * f.width, 0.0, 0.0}, {0.5 * f.width, f.depth, f.height}}, wood,
                    {{Side::Front, poster(random, {0.5 * f.width + 0.06, 0.25}, {0.5 * f.width - 0.12, 0.45})},
                     {Side::Front, label({"LINEN"}, {0.08, 0.3}, {0.24, 0.09})}});
    for (const double x : {-0.06, 0.03})
        builder.add_box({{x, f.depth, 0.45 * f.height}, {x + 0.03, f.depth + 0.03, 0.45 * f.height + 0.14}},
                        material(Pattern::Metal, random, 0.6));
}

void build_sofa(RoomBuilder& builder, const Footprint& f, CounterRandom& random)
{
    const Material cloth = material(Pattern::Fabric, random, 0.6);
    const double x0 = -0.5 * f.width, x1 = 0.5 * f.width, seat = 0.5 * f.height;
    builder.add_box({{x0, 0.0, 0.0}, {x1, 0.22, f.height}}, cloth);
    builder.add_box({{x0 + 0.18, 0.22, 0.0}, {x1 - 0.18, f.depth, seat}}, cloth);
    builder.add_box({{x0, 0.22, 0.0}, {x0 + 0.18, f.depth, 0.72 * f.height}}, cloth);
    builder.add_box({{x1 - 0.18, 0.22, 0.0}, {x1, f.depth, 0.72 * f.height}}, cloth);
    const Rigid tilt = builder.world_from_object() * Eigen::Translation3d(random.uniform(-0.3, 0.3), 0.45, seat) *
                       Eigen::AngleAxisd(random.uniform(-0.5, 0.5), Vector3d::UnitZ());
    builder.begin_object("cushion", tilt);
    builder.add_box({{-0.2, -0.12, 0.0}, {0.2, 0.12, 0.10}}, material(Pattern::Carpet, random, 0.7));
}

void build_chimney(RoomBuilder& builder, const Footprint& f, CounterRandom& random)
{
    const Material brick{Pattern::Brick, {0.62f, 0.34f, 0.26f}, {0.70f, 0.67f, 0.62f}, any_seed(random)};
    builder.add_box({{-0.5 * f.width, 0.0, 0.0}, {0.5 * f.width, f.depth, f.height}}, brick);
}

void build_crates(RoomBuilder& builder, const Footprint& f, CounterRandom& random)
{
    const Material card{Pattern::Cardboard, {0.72f, 0.56f, 0.38f}, {0.50f, 0.36f, 0.22f}, any_seed(random)};
    const std::vector<SideDecal> marks{
        {Side::Front, label({"FRAGILE", {180, 30, 30}}, {0.06, 0.12}, {0.3, 0.12})},
        {Side::Left, label({"BOX " + std::to_string(1 + random.below(90))}, {0.05, 0.1}, {0.2, 0.08})},
        {Side::Top, label({"THIS SIDE UP"}, {0.05, 0.15}, {0.3, 0.08})}};
    const double half_x = 0.44 * f.width, low = 0.55 * f.height;
    builder.add_box({{-half_x, 0.04, 0.0}, {half_x, f.depth - 0.04, low}}, card, marks);
    const Rigid turned = builder.world_from_object() * Eigen::Translation3d(0.0, 0.5 * f.depth, low) *
                         Eigen::AngleAxisd(random.uniform(0.25, 0.6), Vector3d::UnitZ());
    builder.begin_object("crate", turned);
    builder.add_box({{-0.21, -0.15, 0.0}, {0.21, 0.15, f.height - low}}, card, marks);
}

void build_bin(RoomBuilder& builder, const Footprint& f, CounterRandom& random)
{
    const double r = 0.5 * f.width - 0.02;
    const std::vector<Vector2d> profile{
        {0.0, 0.01}, {0.85 * r, 0.01}, {r - 0.006, f.height}, {r, f.height}, {0.86 * r, 0.0}};
    const Decal mark = label({"PAPER"}, {0.2, f.height + 0.25}, {0.2, 0.08});
    builder.add_lathe({0.0, 0.5 * f.depth, 0.0}, profile, {material(Pattern::Fabric, random, 0.6), {mark}});
}

void build_floor_lamp(RoomBuilder& builder, const Footprint& f, CounterRandom& random)
{
    const Vector3d foot(0.0, 0.5 * f.depth, 0.0);
    const std::vector<Vector2d> stand{
        {0.0, f.height - 0.15}, {0.018, f.height - 0.15}, {0.018, 0.03}, {0.14, 0.025}, {0.14, 0.0}};
    builder.add_lathe(foot, stand, {material(Pattern::Metal, random, 0.5), {}});
    const std::vector<Vector2d> shade{
        {0.0, f.height}, {0.11, f.height}, {0.18, f.height - 0.28}, {0.0, f.height - 0.28}};
    builder.add_lathe(foot, shade, {material(Pattern::Fabric, random, 0.85), {}});
}

void build_sideboard(RoomBuilder& builder, const Footprint& f, CounterRandom& random)
{
    builder.add_box({{-0.5 * f.width, 0.0, 0.0}, {0.5 * f.width, f.depth, f.height}}, any_wood(random),
                    {{Side::Front, label({"MAPS"}, {0.10, 0.15}, {0.3, 0.12})},
                     {Side::Front, label({"TOOLS"}, {0.5 * f.width + 0.1, 0.15}, {0.3, 0.12})}});
    const Rigid frame = builder.world_from_object();
    builder.begin_object("books", frame);
    add_books(builder, {-0.45 * f.width, 0.03, f.height}, 0.0, 0.27, random);
    builder.begin_object("vase", frame);
    const std::vector<Vector2d> vase{{0.0, 0.02},   {0.05, 0.02},  {0.04, 0.24}, {0.05, 0.30},
                                     {0.055, 0.30}, {0.047, 0.24}, {0.09, 0.14}, {0.06, 0.0}};
    builder.add_lathe({0.3 * f.width, 0.5 * f.depth, f.height}, vase, {material(Pattern::Wallpaper, random, 0.75), {}});
}

} // namespace

Vector3f any_tint(CounterRandom& random, double light)
{
    const double hue = random.uniform(0.0, 2.0 * std::numbers::pi), strength = random.uniform(0.10, 0.28);
    const auto channel = [&](double phase) {
        return static_cast<float>(std::clamp(light + strength * std::cos(hue + phase), 0.06, 0.9));
    };
    return {channel(0.0), channel(2.1), channel(4.2)};
}

Footprint footprint(Piece piece, double room_height)
{
    switch (piece) {
    case Piece::Stairs:
        return {"stairs", 1.12, 0.75, 0.72};
    case Piece::Bookshelf:
        return {"bookshelf", 0.95, 0.30, 1.85};
    case Piece::Desk:
        return {"desk", 1.35, 0.70, 0.74};
    case Piece::Wardrobe:
        return {"wardrobe", 1.00, 0.55, 1.95};
    case Piece::Sofa:
        return {"sofa", 1.60, 0.85, 0.85};
    case Piece::Chimney:
        return {"chimney", 0.60, 0.35, room_height};
    case Piece::CrateStack:
        return {"crate", 0.60, 0.55, 0.75};
    case Piece::Bin:
        return {"bin", 0.34, 0.34, 0.38};
    case Piece::FloorLamp:
        return {"lamp", 0.40, 0.40, 1.60};
    case Piece::Sideboard:
        return {"sideboard", 1.20, 0.42, 0.80};
    }
    return {};
}

void build_piece(RoomBuilder& builder, Piece piece, const Footprint& f, const Rigid& world_from_object,
                 CounterRandom& random)
{
    builder.begin_object(f.name, world_from_object);
    switch (piece) {
    case Piece::Stairs:
        return build_stairs(builder, f, random);
    case Piece::Bookshelf:
        return build_bookshelf(builder, f, random);
    case Piece::Desk:
        return build_desk(builder, f, random);
    case Piece::Wardrobe:
        return build_wardrobe(builder, f, random);
    case Piece::Sofa:
        return build_sofa(builder, f, random);
    case Piece::Chimney:
        return build_chimney(builder, f, random);
    case Piece::CrateStack:
        return build_crates(builder, f, random);
    case Piece::Bin:
        return build_bin(builder, f, random);
    case Piece::FloorLamp:
        return build_floor_lamp(builder, f, random);
    case Piece::Sideboard:
        return build_sideboard(builder, f, random);
    }
}

void build_picture(RoomBuilder& builder, const Rigid& world_from_object, const Vector2d& size, CounterRandom& random)
{
    builder.begin_object("picture", world_from_object);
    builder.add_box({{-0.5 * size.x(), 0.0, 0.0}, {0.5 * size.x(), 0.03, size.y()}}, any_wood(random),
                    {{Side::Front, poster(random, {0.0, 0.0}, size)}});
}

void build_low_table(RoomBuilder& builder, const Rigid& world_from_object, CounterRandom& random)
{
    builder.begin_object("low table", world_from_object);
    const Material wood = any_wood(random);
    const Box top{{-0.45, -0.28, 0.38}, {0.45, 0.28, 0.42}};
    builder.add_box(top, wood, {{Side::Top, poster(random, {0.08, 0.12}, {0.30, 0.36})}});
    add_legs(builder, top, 0.05, wood);
    builder.begin_object("book", world_from_object * Eigen::AngleAxisd(0.4, Vector3d::UnitZ()));
    builder.add_box({{-0.30, -0.10, 0.42}, {-0.08, 0.07, 0.47}}, material(Pattern::Paper, random, 0.5),
                    {{Side::Top, label({"A ROOM"}, {0.03, 0.04}, {0.16, 0.08})}});
    builder.begin_object("ball", world_from_object);
    constexpr int rings = 24;
    constexpr double radius = 0.13;
    std::vector<Vector2d> ball;
    for (int i = 0; i <= rings; ++i) {
        const double angle = std::numbers::pi * i / rings;
        ball.emplace_back(i == 0 || i == rings ? 0.0 : radius * std::sin(angle), radius * (1.0 + std::cos(angle)));
    }
    builder.add_lathe({0.75, 0.35, 0.0}, ball, {material(Pattern::Tiles, random, 0.6), {}});
}

} // namespace quoin
