// One keyframe, ready to be asked what it sees of a point on the mesh, and how well.
#pragma once

#include "bake/bake_texture.h"

#include <cmath>
#include <optional>
#include <span>
#include <vector>

namespace quoin {

struct Sighting {
    Eigen::Vector2d pixel;   // in the full colour image
    double resolution = 0.0; // pixels per metre on the surface, the geometric mean over its directions
    double facing = 0.0;     // cosine between the surface normal and the direction to the camera
    double trust = 0.0;      // 0..1: lower near edges of depth and of the image, and where depth is missing
    bool is_clear = false;   // of edges, as far as a cubic reaches
};

// What a sighting must keep away from: edges of depth and of the image, and flat angles. The safe margins allow for
// errors of pose and depth. The least ones are for what no view shows safely: the pixels that the colour mixes must all
// show this surface of the mesh. Neither lets the measured depth say that something else is there.
enum class Margins { Safe, Least };

// Points first + i step on a surface [m].
struct PointRow {
    Eigen::Vector3d first, step, normal;
};

class TextureView {
    // A depth [m], 0 where there is none, and its distance to the nearest edge of depth [px of the colour image].
    struct EdgedDepth {
        float depth = 0.0f, to_edge = 0.0f;
    };

public:
    // Loads colour and depth of keyframe k and draws the mesh from its pose.
    TextureView(const BakeInput& input, std::size_t k, const BakeTextureParams& params);

    // Where a point is in the images, which have its pixels brought near: aim at some points before asking what is seen
    // of the first, or every look waits for memory. Reckoned in single precision, eight points at once.
    struct Aim {
        Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
        double z = 0.0, facing = 0.0; // depth [m], 0 = outside the image or the depth range, and cosine
        double measured_z = 0.0;      // depth in the depth camera [m]
        const EdgedDepth* drawn = nullptr;
        const EdgedDepth* measured = nullptr; // nullptr outside the depth image
    };
    void aim(const PointRow& points, Margins margins, std::span<Aim> aims) const;

    // Of what is aimed at, seen or not [px/m].
    double resolution(const Aim& aim) const { return color_camera_.fx * std::sqrt(aim.facing) / aim.z; }

    // nullopt when the point is out of sight: outside the image or the depth range, turned away, hidden by the mesh or
    // by something the mesh lacks, or too near to an edge of depth, where colours of two surfaces mix.
    std::optional<Sighting> see(const Aim& aim, Margins margins) const;

    // By both margins with one look; the aim is by the least ones.
    struct TwoSightings {
        bool by_least_margins = false; // at least by these
        std::optional<Sighting> safe;
    };
    TwoSightings see_by_both(const Aim& aim) const;

    // The recorded colour there, 0..255, from the pyramid level whose pixels are as large as a texel of the given
    // density [1/m].
    Eigen::Vector3f recorded_color(const Sighting& sighting, double density) const;
    // The same by a cubic through four pixels each way (Keys 1981), which keeps the detail that a mean of two
    // blurs; near edges as above.
    Eigen::Vector3f detail_color(const Sighting& sighting, double density) const;
    // A recorded colour in the common exposure, 0..255 and beyond.
    Eigen::Vector3f common_color(const Sighting& sighting, const Eigen::Vector3f& recorded) const;
    Eigen::Vector3f color(const Sighting& sighting, double density) const
    {
        return common_color(sighting, recorded_color(sighting, density));
    }
    // A weight that sinks to nearly 0 where the recorded colour is white without detail.
    static float exposure_weight(const Eigen::Vector3f& recorded);

    double sharpness() const { return sharpness_; } // 0 blurred .. 1 sharp
    // 1 in the middle of the image, towards 0 in its corners (vignetting, distortion).
    double centring(const Eigen::Vector2d& pixel) const;
    std::size_t bytes() const;                                              // that it takes in memory
    bool may_see(const Eigen::Vector3d& centre_world, double radius) const; // could a ball be in the image?

private:
    struct Limits {
        double least_facing = 0.0;
        double edge = 0.0, border = 0.0; // distances to edges of depth and the image's [px]
    };
    struct Place {
        const ColorImage& image;
        Eigen::Vector2d pixel;
    };
    Place in_pyramid(const Sighting& sighting, double density) const;
    static Image<EdgedDepth> edged(const DepthImage& depth, const Image<float>& to_edge, float scale);
    const Limits& limits(Margins margins) const { return margins == Margins::Safe ? safe_ : least_; }
    bool shows_surface(const Aim& aim, const EdgedDepth& drawn) const; // at a pixel of the colour image
    bool mixes_surface_only(const Aim& aim) const;                     // does its bilinear sample?
    bool agrees_with_measured(const Aim& aim) const;
    bool is_within(const Aim& aim, const Limits& limits) const;
    Sighting sighting(const Aim& aim, const Limits& limits) const;
    double edge_ramp(double pixels_to_edge, double margin) const;
    double depth_tolerance(double z, double facing, double focal) const; // [m]
    float correction(const Eigen::Vector2d& pixel) const;

    BakeTextureParams params_;
    Camera color_camera_, depth_camera_;
    Rigid color_from_world_, depth_from_world_;
    std::vector<ColorImage> color_;      // pyramid
    Image<EdgedDepth> drawn_, measured_; // of the mesh in the colour camera; of the sensor in the depth camera
    Eigen::Vector3f gain_, bias_;
    Vignetting vignetting_;
    Limits safe_, least_;
    double sharpness_ = 1.0;
};

} // namespace quoin
