// A frame as the integration wants it: depth with unreliable pixels dropped, and colour and incidence of every depth
// pixel.
#pragma once

#include "fusion/truncation.h"
#include "fusion/voxel_grid.h"
#include "image/image.h"
#include "scan/scan.h"

#include <vector>

namespace quoin {

// What a depth pixel says beside its depth, in one word.
struct PixelSurface {
    Rgb8 color{};
    std::uint8_t incidence = 0; // low 7 bits: 127 * cosine between ray and normal; high bit: there is a colour
};
inline constexpr std::uint8_t kHasColor = 0x80;
inline constexpr float kIncidenceScale = 127.0f;

struct DepthView {
    Camera camera;
    Rigid camera_from_world = Rigid::Identity();
    std::vector<float> depth;          // width * height + 1 [m]; 0 = missing; the last one always is
    std::vector<PixelSurface> surface; // width * height + 1
    Image<float> tile_max;             // largest depth of every tile of kTile x kTile pixels; 0 = none
    bool has_color = false;
};
inline constexpr int kTile = 16; // [px]

struct ViewParams {
    double min_depth = 0.0, max_depth = 0.0; // [m]
    double depth_edge = 0.0;                 // fraction of the depth
    double min_incidence = 0.0;              // cosine
    double occlusion = 0.0; // how far behind what the colour camera sees a point still has its colour [m]
};

// `color` may be empty. Sizes are those of the scan's cameras.
DepthView make_view(const Scan& scan, FrameId id, const DepthImage& depth, const ColorImage& color,
                    const ViewParams& params);

// Keys of the blocks that the rays meet within `truncation` of the measured points, ascending.
std::vector<BlockKey> blocks_near_surface(const DepthView& view, double block_size, const Truncation& truncation);

} // namespace quoin
