#include "synth/material.h"

#include "synth/random.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace quoin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3f;

// A number in 0..1 for every point of a lattice (the mixer is Wellons' lowbias32).
double lattice(std::int64_t x, std::int64_t y, std::uint32_t seed)
{
    std::uint32_t h =
        static_cast<std::uint32_t>(x) * 0x8da6b343u ^ static_cast<std::uint32_t>(y) * 0xd8163841u ^ seed * 0xcb1ab31fu;
    h = (h ^ (h >> 16)) * 0x7feb352du;
    h = (h ^ (h >> 15)) * 0x846ca68bu;
    return static_cast<double>(h ^ (h >> 16)) * 0x1.0p-32;
}

double mix(double a, double b, double t) { return a + t * (b - a); }

// Value noise in 0..1 with features of size 1.
double noise(double x, double y, std::uint32_t seed)
{
    const double fx = std::floor(x), fy = std::floor(y);
    const auto ix = static_cast<std::int64_t>(fx), iy = static_cast<std::int64_t>(fy);
    const auto ease = [](double t) { return t * t * (3.0 - 2.0 * t); };
    const double tx = ease(x - fx), ty = ease(y - fy);
    const double top = mix(lattice(ix, iy, seed), lattice(ix + 1, iy, seed), tx);
    const double bottom = mix(lattice(ix, iy + 1, seed), lattice(ix + 1, iy + 1, seed), tx);
    return mix(top, bottom, ty);
}

// Three octaves, centred on zero, within -0.5..0.5.
double cloud(double x, double y, std::uint32_t seed)
{
    return (noise(x, y, seed) * 4.0 + noise(2.1 * x, 2.1 * y, seed + 1) * 2.0 + noise(4.3 * x, 4.3 * y, seed + 2)) /
               7.0 -
           0.5;
}

double step(double low, double high, double x)
{
    const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

Vector3f blend(const Vector3f& a, const Vector3f& b, double t) { return a + (b - a) * static_cast<float>(t); }
Vector3f shade(const Vector3f& color, double factor) { return color * static_cast<float>(factor); }

Vector3f plaster(const Material& m, const Vector2d& p)
{
    const double stain = cloud(p.x() / 0.35, p.y() / 0.35, m.seed),
                 grain = cloud(p.x() / 0.012, p.y() / 0.012, m.seed + 9);
    const double speck = step(0.80, 0.86, noise(p.x() / 0.009, p.y() / 0.009, m.seed + 17));
    return blend(shade(m.first, 1.0 + 0.16 * stain + 0.22 * grain), m.second, 0.45 * speck);
}

Vector3f wallpaper(const Material& m, const Vector2d& p)
{
    constexpr double pitch = 0.16;
    const double column = std::floor(p.x() / pitch);
    const double y = p.y() / pitch + 0.5 * std::fmod(std::abs(column), 2.0);
    const Vector2d cell(p.x() / pitch - column - 0.5, y - std::floor(y) - 0.5);
    const double angle = std::atan2(cell.y(), cell.x()), radius = cell.norm();
    const double petal = 0.30 + 0.10 * std::cos(5.0 * angle + column);
    const double flower = step(0.02, -0.02, radius - petal) * (1.0 - step(0.02, -0.02, radius - 0.10));
    const double stripe = step(0.46, 0.48, std::abs(cell.x()));
    const double grain =
        1.0 + 0.14 * cloud(p.x() / 0.010, p.y() / 0.010, m.seed) + 0.12 * cloud(p.x() / 0.4, p.y() / 0.4, m.seed + 5);
    return shade(blend(m.first, m.second, std::max(flower, 0.7 * stripe)), grain);
}

// Rectangular units with joints: bricks and tiles.
struct Course {
    double width, height, joint; // [m]
    double shift;                // of every second course, in units
    double variety;              // of the units' lightness
};

Vector3f masonry(const Material& m, const Vector2d& p, const Course& c)
{
    const double row = std::floor(p.y() / c.height);
    const double x = p.x() / c.width + c.shift * std::fmod(std::abs(row), 2.0), column = std::floor(x);
    const double from_x = std::min(x - column, 1.0 - x + column) * c.width;
    const double from_y = std::min(p.y() / c.height - row, 1.0 - p.y() / c.height + row) * c.height;
    const double wobble = 0.0015 * (noise(p.x() / 0.02, p.y() / 0.02, m.seed + 3) - 0.5);
    const double unit = step(0.5 * c.joint - 0.001, 0.5 * c.joint + 0.0015, std::min(from_x, from_y) + wobble);
    const double tone = lattice(static_cast<std::int64_t>(column), static_cast<std::int64_t>(row), m.seed) - 0.5;
    const double grain =
        0.30 * cloud(p.x() / 0.010, p.y() / 0.010, m.seed + 7) + 0.20 * cloud(p.x() / 0.06, p.y() / 0.06, m.seed + 8);
    return blend(shade(m.second, 1.0 + grain), shade(m.first, 1.0 + c.variety * tone + grain), unit);
}

Vector3f wood(const Material& m, const Vector2d& p)
{
    const double bend = 0.03 * cloud(p.x() / 0.5, p.y() / 0.08, m.seed);
    const double ring = std::sin(2.0 * std::numbers::pi *
                                 ((p.y() + bend) / 0.018 + 1.5 * noise(p.x() / 0.9, p.y() / 0.05, m.seed + 4)));
    const double fibre = cloud(p.x() / 0.060, p.y() / 0.005, m.seed + 5);
    return shade(blend(m.first, m.second, 0.30 + 0.22 * ring), 1.0 + 0.35 * fibre);
}

Vector3f planks(const Material& m, const Vector2d& p)
{
    constexpr double width = 0.11, length = 0.85;
    const double row = std::floor(p.y() / width);
    const double x = p.x() / length + 0.618 * row, column = std::floor(x);
    Material board = m;
    board.seed = static_cast<std::uint32_t>(mix_bits(static_cast<std::uint64_t>(row * 4096.0 + column) ^ m.seed));
    const double from_side = std::min(p.y() - row * width, (row + 1.0) * width - p.y());
    const double from_end = std::min(x - column, 1.0 - x + column) * length;
    const double joint = 1.0 - step(0.0005, 0.003, std::min(from_side, from_end));
    const double tone =
        0.82 + 0.36 * lattice(static_cast<std::int64_t>(column), static_cast<std::int64_t>(row), m.seed);
    return shade(wood(board, p), tone * (1.0 - 0.7 * joint));
}

Vector3f carpet(const Material& m, const Vector2d& p)
{
    const double tuft = noise(p.x() / 0.006, p.y() / 0.006, m.seed) - 0.5,
                 pile = cloud(p.x() / 0.05, p.y() / 0.05, m.seed + 2);
    const Vector2d cell(p.x() / 0.30 - std::floor(p.x() / 0.30) - 0.5, p.y() / 0.30 - std::floor(p.y() / 0.30) - 0.5);
    const double diamond = std::abs(cell.x()) + std::abs(cell.y());
    const double line = step(0.035, 0.02, std::abs(diamond - 0.36)) + step(0.10, 0.08, diamond);
    return shade(blend(m.first, m.second, std::min(line, 1.0)), 1.0 + 0.65 * tuft + 0.30 * pile);
}

Vector3f fabric(const Material& m, const Vector2d& p)
{
    const double weave =
        std::sin(2.0 * std::numbers::pi * p.x() / 0.010) * std::sin(2.0 * std::numbers::pi * p.y() / 0.010);
    const double thread = cloud(p.x() / 0.008, p.y() / 0.008, m.seed),
                 fold = cloud(p.x() / 0.15, p.y() / 0.15, m.seed + 3);
    const double check = 0.5 * (step(0.45, 0.55, p.x() / 0.12 - std::floor(p.x() / 0.12)) +
                                step(0.45, 0.55, p.y() / 0.12 - std::floor(p.y() / 0.12)));
    return shade(blend(m.first, m.second, 0.6 * check), 1.0 + 0.12 * weave + 0.40 * thread + 0.20 * fold);
}

Vector3f cardboard(const Material& m, const Vector2d& p)
{
    const double flute = 0.05 * std::sin(2.0 * std::numbers::pi * p.x() / 0.014),
                 fleck = step(0.75, 0.82, noise(p.x() / 0.007, p.y() / 0.007, m.seed));
    const double tape = step(0.028, 0.025, std::abs(p.y() - 0.06));
    const Vector3f board = shade(m.first, 1.0 + flute + 0.25 * cloud(p.x() / 0.08, p.y() / 0.08, m.seed + 1));
    return blend(blend(board, m.second, 0.5 * fleck), m.second, 0.5 * tape);
}

Vector3f paper(const Material& m, const Vector2d& p)
{
    return shade(m.first, 1.0 + 0.16 * cloud(p.x() / 0.02, p.y() / 0.02, m.seed) +
                              0.10 * cloud(p.x() / 0.006, p.y() / 0.006, m.seed + 6));
}

Vector3f metal(const Material& m, const Vector2d& p)
{
    return shade(blend(m.first, m.second, 0.5 + cloud(p.x() / 0.10, p.y() / 0.10, m.seed)),
                 1.0 + 0.35 * cloud(p.x() / 0.15, p.y() / 0.004, m.seed + 2));
}

// Hills under clouds, as through a window.
Vector3f sky(const Material& m, const Vector2d& p)
{
    const double cover = step(-0.05, 0.18, cloud(p.x() / 0.5, p.y() / 0.22, m.seed));
    const Vector3f heaven = blend(m.first, Vector3f(0.92f, 0.92f, 0.92f), cover);
    const double ridge = 0.70 + 0.25 * cloud(p.x() / 0.6, 0.0, m.seed + 4),
                 near_ridge = 0.86 + 0.2 * cloud(p.x() / 0.25, 0.0, m.seed + 5);
    const Vector3f leaves = shade(m.second, 1.0 + 0.9 * cloud(p.x() / 0.02, p.y() / 0.02, m.seed + 6));
    const Vector3f far = blend(heaven, blend(m.second, m.first, 0.45), step(0.0, 0.008, p.y() - ridge));
    return blend(far, leaves, step(0.0, 0.008, p.y() - near_ridge));
}

Vector3f pattern_color(const Material& m, const Vector2d& p)
{
    switch (m.pattern) {
    case Pattern::Plaster:
        return plaster(m, p);
    case Pattern::Wallpaper:
        return wallpaper(m, p);
    case Pattern::Brick:
        return masonry(m, p, {0.21, 0.071, 0.010, 0.5, 0.45});
    case Pattern::Tiles:
        return masonry(m, p, {0.20, 0.20, 0.006, 0.0, 0.22});
    case Pattern::Planks:
        return planks(m, p);
    case Pattern::Wood:
        return wood(m, p);
    case Pattern::Carpet:
        return carpet(m, p);
    case Pattern::Fabric:
        return fabric(m, p);
    case Pattern::Cardboard:
        return cardboard(m, p);
    case Pattern::Paper:
        return paper(m, p);
    case Pattern::Metal:
        return metal(m, p);
    case Pattern::Sky:
        return sky(m, p);
    }
    return m.first;
}

} // namespace

Vector3f albedo(const Material& material, const Vector2d& uv)
{
    return pattern_color(material, uv).cwiseMax(0.02f).cwiseMin(0.95f);
}

} // namespace quoin
