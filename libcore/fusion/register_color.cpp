#include "fusion/register_color.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>

namespace quoin {
namespace {

constexpr float kNoDepth = std::numeric_limits<float>::max();

// Where a row of depth pixels lies in the colour image.
struct ColorRow {
    explicit ColorRow(std::size_t width) : u(width), v(width), z(width) {}
    std::vector<float> u, v; // [px]
    std::vector<float> z;    // [m], in the colour camera; 0 where the pixel is missing or outside the image
};

// From the depth camera into the colour camera.
class ColorProjection {
public:
    explicit ColorProjection(const Scan& scan) : color_(scan.color), depth_(scan.depth)
    {
        const Rigid color_from_depth = scan.depth_from_color.inverse();
        R_ = color_from_depth.linear().cast<float>();
        t_ = color_from_depth.translation().cast<float>();
    }
    void project(const PaddedDepth& depth, int y, ColorRow& row) const
    {
        const auto fx = static_cast<float>(color_.fx), fy = static_cast<float>(color_.fy);
        const auto cx = static_cast<float>(color_.cx), cy = static_cast<float>(color_.cy);
        const auto right = static_cast<float>(color_.width - 1), bottom = static_cast<float>(color_.height - 1);
        const auto inverse_fx = static_cast<float>(1.0 / depth_.fx), depth_cx = static_cast<float>(depth_.cx);
        const auto ray_y = static_cast<float>((y - depth_.cy) / depth_.fy);
        const Eigen::Vector3f base = R_.col(1) * ray_y + R_.col(2), step = R_.col(0), t = t_;
        const float* z = depth.row(y);
        float *u_row = row.u.data(), *v_row = row.v.data(), *z_row = row.z.data();
        for (int x = 0; x < depth.width(); ++x) {
            const float ray_x = (static_cast<float>(x) - depth_cx) * inverse_fx;
            const float px = z[x] * (base.x() + ray_x * step.x()) + t.x(),
                        py = z[x] * (base.y() + ray_x * step.y()) + t.y();
            const float pz = z[x] * (base.z() + ray_x * step.z()) + t.z();
            const float u = fx * px / pz + cx, v = fy * py / pz + cy;
            const bool inside = (z[x] > 0.0f) & (pz > 0.0f) & (u >= 0.0f) & (v >= 0.0f) & (u < right) & (v < bottom);
            u_row[x] = inside ? u : 0.0f;
            v_row[x] = inside ? v : 0.0f;
            z_row[x] = inside ? pz : 0.0f;
        }
    }

private:
    Camera color_, depth_;
    Eigen::Matrix3f R_; // of color_from_depth
    Eigen::Vector3f t_;
};

// Nearest depth in cells of the colour image, coarse enough that the depth pixels leave no holes in a surface.
class NearestDepth {
public:
    explicit NearestDepth(const Scan& scan)
    {
        constexpr double kDepthPixels = 2.0; // across a cell
        const double cell = kDepthPixels * std::max(1.0, static_cast<double>(scan.color.width) / scan.depth.width);
        per_pixel_ = static_cast<float>(1.0 / cell);
        nearest_ = Image<float>(static_cast<int>(scan.color.width / cell) + 1,
                                static_cast<int>(scan.color.height / cell) + 1, kNoDepth);
    }
    void add(const ColorRow& row)
    {
        for (std::size_t i = 0; i < row.z.size(); ++i) {
            if (row.z[i] <= 0.0f) continue;
            float& z = nearest_.pixels[static_cast<std::size_t>(cell(row.u[i], row.v[i]))];
            z = std::min(z, row.z[i]);
        }
    }
    float at(float u, float v) const { return nearest_.pixels[static_cast<std::size_t>(cell(u, v))]; }

private:
    std::int32_t cell(float u, float v) const
    {
        return static_cast<std::int32_t>(v * per_pixel_) * nearest_.width + static_cast<std::int32_t>(u * per_pixel_);
    }
    float per_pixel_ = 1.0f; // cells
    Image<float> nearest_;
};

// Three bytes as a word: red is the lowest.
std::uint32_t word_at(const std::uint8_t* bytes)
{
    std::uint32_t word;
    std::memcpy(&word, bytes, sizeof(word));
    return word;
}

// Bilinear samples of a row of pixels, with weights in 256ths. Corners are fetched one by one and then blended in
// words, a channel at a time: loops that the compiler vectorises.
class RowSampler {
public:
    RowSampler(const ColorImage& image, std::size_t width)
        : image_(image), fx_(width), fy_(width), corner_{Words(width), Words(width), Words(width), Words(width)},
          color_(width)
    {
    }
    // Red, green and blue from the lowest byte up. (u, v) is left of and above the last pixel of an image of at least
    // 2 x 2 pixels.
    const std::vector<std::uint32_t>& sample(const ColorRow& row)
    {
        fetch(row);
        std::fill(color_.begin(), color_.end(), 0u);
        for (std::uint32_t c = 0; c < 3; ++c)
            blend(8 * c);
        return color_;
    }

private:
    using Words = std::vector<std::uint32_t>;

    void fetch(const ColorRow& row)
    {
        const std::uint8_t* pixels = image_.pixels.front().data();
        const std::size_t stride = 3 * static_cast<std::size_t>(image_.width);
        for (std::size_t i = 0; i < color_.size(); ++i) {
            const auto x = static_cast<std::int32_t>(row.u[i]), y = static_cast<std::int32_t>(row.v[i]);
            fx_[i] = static_cast<std::int32_t>((row.u[i] - static_cast<float>(x)) * 256.0f);
            fy_[i] = static_cast<std::int32_t>((row.v[i] - static_cast<float>(y)) * 256.0f);
            const std::uint8_t* top = pixels + static_cast<std::size_t>(y) * stride + 3 * static_cast<std::size_t>(x);
            const std::uint8_t* bottom = top + stride;
            corner_[0][i] = word_at(top); // a word has a byte too many: of the neighbour to the side that there is
            corner_[1][i] = word_at(top + 2) >> 8;
            corner_[2][i] = word_at(bottom);
            corner_[3][i] = word_at(bottom + 2) >> 8;
        }
    }

    void blend(std::uint32_t shift)
    {
        const std::uint32_t *a = corner_[0].data(), *b = corner_[1].data(), *c = corner_[2].data(),
                            *d = corner_[3].data();
        const std::int32_t *fx = fx_.data(), *fy = fy_.data();
        std::uint32_t* color = color_.data();
        const auto channel = [shift](std::uint32_t word) { return static_cast<std::int32_t>(word >> shift & 255u); };
        for (std::size_t i = 0; i < color_.size(); ++i) {
            const std::int32_t above = channel(a[i]) * (256 - fx[i]) + channel(b[i]) * fx[i],
                               below = channel(c[i]) * (256 - fx[i]) + channel(d[i]) * fx[i];
            const std::int32_t mean = (above * (256 - fy[i]) + below * fy[i] + (1 << 15)) >> 16;
            color[i] |= static_cast<std::uint32_t>(mean) << shift;
        }
    }

    const ColorImage& image_;
    std::vector<std::int32_t> fx_, fy_; // [1/256]
    std::array<Words, 4> corner_;       // top left, top right, bottom left, bottom right
    std::vector<std::uint32_t> color_;
};

// Depth 0 for the pixels of a row that have no surface or that something hides from the colour camera; is any left?
bool keep_visible(const NearestDepth& nearest, const ViewParams& params, const float* surface_depth, ColorRow& row)
{
    const auto slack = static_cast<float>(params.occlusion), slack_ratio = static_cast<float>(params.depth_edge);
    bool visible = false;
    for (std::size_t x = 0; x < row.z.size(); ++x) {
        const float z = row.z[x];
        const bool hidden = z > nearest.at(row.u[x], row.v[x]) + slack + slack_ratio * z;
        row.z[x] = (hidden | (surface_depth[x] <= 0.0f)) ? 0.0f : z;
        visible |= row.z[x] > 0.0f;
    }
    return visible;
}

} // namespace

void register_color(const Scan& scan, const PaddedDepth& measured, const ColorImage& color, const ViewParams& params,
                    DepthView& view)
{
    const auto width = static_cast<std::size_t>(measured.width());
    const ColorProjection projection(scan);
    ColorRow row(width);
    NearestDepth nearest(scan);
    for (int y = 0; y < measured.height(); ++y) {
        projection.project(measured, y, row);
        nearest.add(row);
    }
    RowSampler sampler(color, width);
    for (int y = 0; y < measured.height(); ++y) {
        projection.project(measured, y, row);
        const std::size_t first = static_cast<std::size_t>(y) * width;
        if (!keep_visible(nearest, params, view.depth.data() + first, row)) continue;
        const auto& sampled = sampler.sample(row);
        for (std::size_t x = 0; x < width; ++x) {
            if (row.z[x] <= 0.0f) continue;
            const std::uint32_t incidence = view.surface[first + x].incidence | kHasColor;
            view.surface[first + x] = std::bit_cast<PixelSurface>(sampled[x] | incidence << 24);
        }
    }
    view.has_color = true;
}

} // namespace quoin
