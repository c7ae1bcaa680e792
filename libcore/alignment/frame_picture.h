// What one frame's picture shows of points, eight at a time.
#pragma once

#include "alignment/observations.h"

#include <array>

namespace quoin {

// Of eight observations: the grey, not corrected by the exposure, 0..1; its derivatives by the place (X/Z, Y/Z) where
// the colour camera sees the texel; and that place. A point outside the image takes the colour of its border, with no
// derivative: the energy keeps its set of terms.
struct SampleLanes {
    Floats value, by_x, by_y, x, y;
};

// Of a frame at a level, taken by its colour camera.
class FramePicture {
public:
    using Projection = Eigen::Matrix<float, 3, 4>; // from points, by way of their plane, to the colour camera

    FramePicture(const CornerImage& gray, const Camera& camera, const Rigid& color_from_world)
        : gray_(gray), color_from_world_(color_from_world), fx_(static_cast<float>(camera.fx)),
          fy_(static_cast<float>(camera.fy)), cx_(static_cast<float>(camera.cx)), cy_(static_cast<float>(camera.cy)),
          x_max_(static_cast<float>(gray.width()) - kInside), y_max_(static_cast<float>(gray.height()) - kInside)
    {
    }
    Projection projection(const CenteredPlane& plane) const
    {
        return (color_from_world_ * plane.projection()).matrix().topRows<3>().cast<float>();
    }
    // Where eight points are.
    struct Place {
        Floats x, y;
        CornerImage::Place corner;
        Ints seen, in_row, in_column; // before the camera; and not clamped
    };
    // Of texels[index]; `texels` are not none. What sample() will read is brought near: let it wait until some dozens
    // have been placed.
    [[gnu::always_inline]] Place place(const Projection& A, const std::vector<Eigen::Vector3f>& texels,
                                       const Ints& index) const
    {
        const float* points = texels.front().data();
        const Ints at = 3 * index;
        const Floats p = gather(points, at), q = gather(points + 1, at), r = gather(points + 2, at);
        const Floats X = A(0, 0) * p + A(0, 1) * q + A(0, 2) * r + A(0, 3);
        const Floats Y = A(1, 0) * p + A(1, 1) * q + A(1, 2) * r + A(1, 3);
        const Floats Z = A(2, 0) * p + A(2, 1) * q + A(2, 2) * r + A(2, 3);
        const Ints seen = Z >= kMinDepth;
        const Floats inverse = 1.0f / (seen ? Z : each(kMinDepth));
        const Floats x = X * inverse, y = Y * inverse;
        const Floats u = fx_ * x + cx_, v = fy_ * y + cy_;
        const Floats column = clamped(u, x_max_), row = clamped(v, y_max_);
        const Place place{x, y, gray_.place(column, row), seen, seen & (column == u), seen & (row == v)};
        gray_.prefetch(place.corner);
        return place;
    }
    [[gnu::always_inline]] SampleLanes sample(const Place& place) const
    {
        const CornerImage::Samples gray = gray_.sample(place.corner);
        return {place.seen ? gray.value : Floats{}, place.in_row ? fx_ * gray.by_u : Floats{},
                place.in_column ? fy_ * gray.by_v : Floats{}, place.x, place.y};
    }

private:
    static constexpr float kMinDepth = 1e-3f; // [m]; points nearer to the camera plane have no pixel
    static constexpr float kInside = 1.001f;  // [px] from the size of an image to the last place with four corners

    static Floats clamped(const Floats& value, float most)
    {
        const Floats low = value < most ? value : each(most);
        return low > 0.0f ? low : Floats{};
    }

    const CornerImage& gray_;
    Rigid color_from_world_;
    float fx_, fy_, cx_, cy_, x_max_, y_max_;
};

// Observations that are placed together, then sampled together.
inline constexpr std::size_t kPlaces = 32; // lanes of eight
using Places = std::array<FramePicture::Place, kPlaces>;

inline FramePicture frame_picture(const AlignmentScene& scene, const AlignmentState& state, std::size_t k, int level)
{
    return {scene.images[k].gray[static_cast<std::size_t>(level)], state.color.camera.at_level(level),
            state.color.color_from_depth * state.camera_from_world[k]};
}

} // namespace quoin
