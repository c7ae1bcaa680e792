#include "bake/texture_view.h"

#include "bake/distance_field.h"
#include "base/lanes.h"
#include "image/sampling.h"
#include "render/rasterize.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace quoin {
namespace {

constexpr int kLeastPyramidSide = 32;    // [px]
constexpr double kSigmas = 3.0;          // of the sensor's noise that still count as agreement
constexpr double kUnmeasuredTrust = 0.2; // where the sensor gave no depth, something unmodelled may stand in front
constexpr float kFarFromEdges = 1e6f;    // [px]
constexpr double kBilinearReach = 2.0;   // from a rounded pixel to the farthest that its colour mixes [px]
constexpr double kCubicReach = 4.0;      // the same of a cubic
constexpr double kLeastRamp = 0.02;      // weight right at the margin; better than no view at all
constexpr float kSaturated = 250.0f;     // recorded grey level whose true brightness is unknown
constexpr float kSaturatedWeight = 0.1f;
constexpr double kHalfPixel = 0.499;    // outside of the first and last pixel, which are the nearest still
constexpr double kCornerCentring = 0.5; // quality of the image's corners against its middle

// Starts of distances: 0 at a step of depth, far elsewhere. The inverse depth of a plane is linear in the image, so its
// second difference is 0 on every plane, however oblique, and z^2 times it is the step [m].
Image<float> depth_steps(const DepthImage& depth, double jump, double noise)
{
    const auto step_limit = static_cast<float>(jump);
    const auto noise_limit = static_cast<float>(kSigmas * std::sqrt(6.0) * noise);
    Image<float> inverse(depth.width, depth.height);
    for (std::size_t i = 0; i < depth.pixels.size(); ++i)
        inverse.pixels[i] = depth.pixels[i] > 0.0f ? 1.0f / depth.pixels[i] : 0.0f;
    Image<float> start(depth.width, depth.height, kFarFromEdges);
    // `count` pixels from (x, y) on, with their neighbours on two opposite sides.
    const auto mark = [&](int x, int y, int count, const float* before, const float* after) {
        const float *at = inverse.row(y) + x, *z = depth.row(y) + x;
        float* result = start.row(y) + x;
        for (int i = 0; i < count; ++i) {
            const float square = z[i] * z[i], step = std::abs(before[i] - 2.0f * at[i] + after[i]) * square;
            const bool known = (at[i] > 0.0f) & (before[i] > 0.0f) & (after[i] > 0.0f);
            const bool stepped = known & (step > std::max(step_limit, noise_limit * square));
            result[i] = stepped ? 0.0f : result[i];
        }
    };
    for (int y = 0; y < depth.height; ++y) {
        if (depth.width > 2) mark(1, y, depth.width - 2, inverse.row(y), inverse.row(y) + 2);
        if (y > 0 && y + 1 < depth.height) mark(0, y, depth.width, inverse.row(y - 1), inverse.row(y + 1));
    }
    return start;
}

// The mesh's own border is less of an edge than a step: only pixels that a bilinear sample would mix are kept away
// from.
void add_mesh_border(const DepthImage& drawn, double margin, Image<float>& start)
{
    const auto distance = static_cast<float>(std::max(0.0, margin - kBilinearReach));
    for (std::size_t i = 0; i < drawn.pixels.size(); ++i)
        if (drawn.pixels[i] <= 0.0f) start.pixels[i] = std::min(start.pixels[i], distance);
}

Image<float> distance_to_drawn_edges(const DepthImage& drawn, const BakeTextureParams& params)
{
    Image<float> start = depth_steps(drawn, params.depth_jump, 0.0);
    add_mesh_border(drawn, params.edge_margin, start);
    return grow_distances(std::move(start), 0.0f);
}

std::vector<ColorImage> pyramid(ColorImage image)
{
    std::vector<ColorImage> levels;
    levels.push_back(std::move(image));
    while (std::min(levels.back().width, levels.back().height) >= 2 * kLeastPyramidSide)
        levels.push_back(half_size(levels.back()));
    return levels;
}

double cosine(double degrees) { return std::cos(degrees * std::numbers::pi / 180.0); }

// Eight points of a row in an image.
struct ImageLanes {
    Floats u, v, z, facing; // pixel, depth [m] and cosine
    Ints in_image;          // before the camera and within the image
    Ints nearest;           // pixel, counted by rows
};

// A row of points before a camera.
struct RowInImage {
    const Camera& camera;
    Eigen::Vector3f first, step, normal;

    RowInImage(const PointRow& points, const Camera& camera_, const Rigid& camera_from_world)
        : camera(camera_), first((camera_from_world * points.first).cast<float>()),
          step((camera_from_world.linear() * points.step).cast<float>()),
          normal((camera_from_world.linear() * points.normal).cast<float>())
    {
    }
    // Points i to i + 7; the image begins and ends `border` pixels inside of its first and last.
    ImageLanes from(std::size_t i, double border) const
    {
        constexpr Floats kCount{0, 1, 2, 3, 4, 5, 6, 7};
        const auto f = [](double value) { return static_cast<float>(value); };
        const Floats at = kCount + static_cast<float>(i);
        const Floats X = first.x() + at * step.x(), Y = first.y() + at * step.y(), Z = first.z() + at * step.z();
        const Floats u = f(camera.fx) * X / Z + f(camera.cx), v = f(camera.fy) * Y / Z + f(camera.cy);
        const float right = f(camera.width - 1 - border), bottom = f(camera.height - 1 - border);
        const Floats toward = -(normal.x() * X + normal.y() * Y + normal.z() * Z);
        const Ints in_image = (Z > 0.0f) & (u >= f(border)) & (v >= f(border)) & (u <= right) & (v <= bottom);
        // 0 outside, where the number of a pixel may be too large to be one.
        const Ints x = __builtin_convertvector(u + 0.5f, Ints) & in_image;
        const Ints y = __builtin_convertvector(v + 0.5f, Ints) & in_image;
        return {u, v, Z, toward / square_root(X * X + Y * Y + Z * Z), in_image, y * camera.width + x};
    }
};

} // namespace

TextureView::TextureView(const BakeInput& input, std::size_t k, const BakeTextureParams& params)
    : params_(params), color_camera_(input.alignment.color), depth_camera_(input.images.scan().depth),
      color_from_world_(input.alignment.color_from_world(k)), depth_from_world_(input.alignment.camera_from_world[k]),
      color_(pyramid(input.images.color(input.keyframes.frame[k]))), gain_(input.alignment.gain[k]),
      bias_(input.alignment.bias[k]),
      vignetting_(input.alignment.vignetting), safe_{cosine(params.max_view_angle), params.edge_margin, 1.0},
      least_{std::min(safe_.least_facing, cosine(params.last_view_angle)), 0.0, 0.0}
{
    const FrameId frame = input.keyframes.frame[k];
    const float blur = frame < input.keyframes.blur.size() ? input.keyframes.blur[frame] : 0.0f;
    sharpness_ = std::isfinite(blur) ? 1.0 - std::clamp<double>(blur, 0.0, 1.0) : 1.0;
    const DepthImage drawn = rasterize(input.planes.mesh, color_camera_, color_from_world_).depth;
    drawn_ = edged(drawn, distance_to_drawn_edges(drawn, params), 1.0f);
    const DepthImage measured = input.images.depth(frame);
    const Image<float> to_edge =
        grow_distances(depth_steps(measured, params.depth_jump, params.depth_noise), kFarFromEdges);
    measured_ = edged(measured, to_edge, static_cast<float>(color_camera_.fx / depth_camera_.fx));
}

// Side by side, for who asks for one asks for both.
Image<TextureView::EdgedDepth> TextureView::edged(const DepthImage& depth, const Image<float>& to_edge, float scale)
{
    Image<EdgedDepth> result(depth.width, depth.height);
    for (std::size_t i = 0; i < result.pixels.size(); ++i)
        result.pixels[i] = {depth.pixels[i], scale * to_edge.pixels[i]};
    return result;
}

std::size_t TextureView::bytes() const
{
    std::size_t result = (drawn_.pixels.size() + measured_.pixels.size()) * sizeof(EdgedDepth);
    for (const auto& level : color_)
        result += level.pixels.size() * sizeof(Rgb8);
    return result;
}

double TextureView::edge_ramp(double pixels_to_edge, double margin) const
{
    if (pixels_to_edge < margin) return 0.0;
    if (pixels_to_edge >= margin + params_.edge_feather) return 1.0;
    return std::max(kLeastRamp, (pixels_to_edge - margin) / params_.edge_feather);
}

// Beside error and noise, the depth of an oblique surface changes within a pixel.
double TextureView::depth_tolerance(double z, double facing, double focal) const
{
    return std::max(params_.depth_tolerance, kSigmas * params_.depth_noise * z * z) + z / (focal * facing);
}

void TextureView::aim(const PointRow& points, Margins margins, std::span<Aim> aims) const
{
    const Limits& limit = limits(margins);
    const RowInImage in_color(points, color_camera_, color_from_world_);
    const RowInImage in_depth(points, depth_camera_, depth_from_world_);
    for (std::size_t first = 0; first < aims.size(); first += kFloats) {
        const ImageLanes color = in_color.from(first, limit.border), depth = in_depth.from(first, -kHalfPixel);
        const Ints in_reach = (color.z >= static_cast<float>(params_.min_depth)) &
                              (color.z <= static_cast<float>(params_.max_depth)) &
                              (color.facing >= static_cast<float>(limit.least_facing));
        const unsigned in_sight = bits(color.in_image & in_reach), in_depth_image = bits(depth.in_image);
        for (std::size_t i = 0; i < std::min(kFloats, aims.size() - first); ++i) {
            Aim& aim = aims[first + i];
            aim = {};
            if ((in_sight >> i & 1u) == 0) continue;
            aim = {{color.u[i], color.v[i]}, color.z[i], color.facing[i], depth.z[i], nullptr, nullptr};
            aim.drawn = &drawn_.pixels[static_cast<std::size_t>(color.nearest[i])];
            __builtin_prefetch(aim.drawn);
            __builtin_prefetch(&color_[0].pixels[static_cast<std::size_t>(color.nearest[i])]);
            if ((in_depth_image >> i & 1u) == 0 || measured_.pixels.empty()) continue;
            aim.measured = &measured_.pixels[static_cast<std::size_t>(depth.nearest[i])];
            __builtin_prefetch(aim.measured);
        }
    }
}

bool TextureView::shows_surface(const Aim& aim, const EdgedDepth& drawn) const
{
    const double tolerance = depth_tolerance(aim.z, aim.facing, color_camera_.fx);
    return drawn.depth > 0.0f && std::abs(drawn.depth - aim.z) <= tolerance;
}

bool TextureView::mixes_surface_only(const Aim& aim) const
{
    const int x0 = static_cast<int>(std::floor(aim.pixel.x())), x1 = static_cast<int>(std::ceil(aim.pixel.x()));
    const int y0 = static_cast<int>(std::floor(aim.pixel.y())), y1 = static_cast<int>(std::ceil(aim.pixel.y()));
    return shows_surface(aim, drawn_.at(x0, y0)) && shows_surface(aim, drawn_.at(x1, y0)) &&
           shows_surface(aim, drawn_.at(x0, y1)) && shows_surface(aim, drawn_.at(x1, y1));
}

bool TextureView::agrees_with_measured(const Aim& aim) const
{
    if (!aim.measured || aim.measured->depth == 0.0f) return true;
    const double tolerance = depth_tolerance(aim.measured_z, aim.facing, depth_camera_.fx);
    return std::abs(aim.measured->depth - aim.measured_z) <= tolerance;
}

bool TextureView::is_within(const Aim& aim, const Limits& limits) const
{
    return color_camera_.contains(aim.pixel, limits.border) && aim.facing >= limits.least_facing &&
           aim.drawn->to_edge >= limits.edge &&
           (!aim.measured || aim.measured->depth == 0.0f || aim.measured->to_edge >= limits.edge);
}

Sighting TextureView::sighting(const Aim& aim, const Limits& limits) const
{
    const bool is_measured = aim.measured && aim.measured->depth > 0.0f;
    const double measured_trust = is_measured ? edge_ramp(aim.measured->to_edge, limits.edge) : kUnmeasuredTrust;
    return {aim.pixel, resolution(aim), aim.facing, edge_ramp(aim.drawn->to_edge, limits.edge) * measured_trust,
            aim.drawn->to_edge >= limits.edge + kCubicReach - kBilinearReach};
}

std::optional<Sighting> TextureView::see(const Aim& aim, Margins margins) const
{
    if (aim.z == 0.0 || !is_within(aim, limits(margins)) || !shows_surface(aim, *aim.drawn) ||
        !agrees_with_measured(aim))
        return std::nullopt;
    // The safe margins keep all that a colour mixes away from edges.
    if (margins == Margins::Least && !mixes_surface_only(aim)) return std::nullopt;
    return sighting(aim, limits(margins));
}

TextureView::TwoSightings TextureView::see_by_both(const Aim& aim) const
{
    if (!see(aim, Margins::Least)) return {};
    return {true, is_within(aim, safe_) ? std::optional(sighting(aim, safe_)) : std::nullopt};
}

TextureView::Place TextureView::in_pyramid(const Sighting& sighting, double density) const
{
    // A texel of at least sqrt(2) pixels is nearer to the next level.
    std::size_t level = 0;
    for (double pixels = sighting.resolution / density; pixels > std::numbers::sqrt2 && level + 1 < color_.size();
         pixels /= 2.0)
        ++level;
    const double scale = 1.0 / static_cast<double>(1u << level);
    return {color_[level], (sighting.pixel.array() + 0.5) * scale - 0.5};
}

Eigen::Vector3f TextureView::recorded_color(const Sighting& sighting, double density) const
{
    const auto [image, pixel] = in_pyramid(sighting, density);
    // Bilinear samples need a neighbour on every side.
    const double x = std::clamp(pixel.x(), 0.0, image.width - 1.001),
                 y = std::clamp(pixel.y(), 0.0, image.height - 1.001);
    return sample_color(image, x, y);
}

Eigen::Vector3f TextureView::detail_color(const Sighting& sighting, double density) const
{
    if (!sighting.is_clear) return recorded_color(sighting, density);
    const auto [image, pixel] = in_pyramid(sighting, density);
    return sample_color_cubic(image, pixel.x(), pixel.y());
}

Eigen::Vector3f TextureView::common_color(const Sighting& sighting, const Eigen::Vector3f& recorded) const
{
    return correction(sighting.pixel) * gain_.cwiseProduct(recorded) + bias_;
}

// Of vignetting.
float TextureView::correction(const Eigen::Vector2d& pixel) const
{
    return static_cast<float>(
        vignetting_.correction(Vignetting::squared_radius(color_camera_.width, color_camera_.height, pixel)));
}

float TextureView::exposure_weight(const Eigen::Vector3f& recorded)
{
    return recorded.maxCoeff() >= kSaturated ? kSaturatedWeight : 1.0f;
}

double TextureView::centring(const Eigen::Vector2d& pixel) const
{
    const Eigen::Vector2d half(0.5 * color_camera_.width, 0.5 * color_camera_.height);
    const double radius2 = (pixel - half).squaredNorm() / half.squaredNorm();
    return 1.0 - (1.0 - kCornerCentring) * radius2;
}

bool TextureView::may_see(const Eigen::Vector3d& centre_world, double radius) const
{
    const Eigen::Vector3d c = color_from_world_ * centre_world;
    const Camera& camera = color_camera_;
    if (c.z() + radius < params_.min_depth || c.z() - radius > params_.max_depth) return false;
    const auto outside = [&](const Eigen::Vector3d& inward) { return inward.normalized().dot(c) < -radius; };
    return !outside({camera.fx, 0.0, camera.cx}) && !outside({-camera.fx, 0.0, camera.width - 1 - camera.cx}) &&
           !outside({0.0, camera.fy, camera.cy}) && !outside({0.0, -camera.fy, camera.height - 1 - camera.cy});
}

} // namespace quoin
