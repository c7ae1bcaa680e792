// Fuses the depth images of a scan into one coloured triangle mesh (Curless and Levoy 1996: a volume of truncated
// signed distances; Niessner et al. 2013: only the blocks of voxels near the surface exist).
#pragma once

#include "base/param.h"
#include "image/image.h"
#include "mesh/triangle_mesh.h"
#include "scan/scan.h"

#include <array>
#include <functional>

namespace quoin {

// Auto: the scan's own dense mesh if it brings one, its frames otherwise.
enum class FuseSource { Auto, Frames, Mesh };
constexpr auto choice_names(FuseSource) { return std::array{"auto", "frames", "mesh"}; }

struct FuseParams {
    FuseSource source = FuseSource::Auto;
    double voxel_size = 0.01;
    double truncation = 0.04;
    double depth_noise = 0.0012;
    double min_depth = 0.2;
    double max_depth = 6.0;
    double depth_edge = 0.03;
    double min_incidence = 0.15;
    double min_weight = 0.5;
    double min_weight_share = 0.2;
    int min_component_faces = 200;
    double min_component_area = 0.01;
    double plausible_extent = 100.0;
    double memory_limit = 4.0;

    static constexpr auto list()
    {
        using P = FuseParams;
        return std::tuple{
            Param{"source", &P::source, "", "where the mesh comes from; auto takes the scan's own mesh if it has one"},
            Param{"voxel_size", &P::voxel_size, "m", "edge of a voxel", 0.001, 0.5},
            Param{"truncation", &P::truncation, "m",
                  "distance to the surface at which distances are cut off; at least 3 voxels", 0.003, 2.0},
            Param{"depth_noise", &P::depth_noise, "1/m",
                  "noise of a depth z is depth_noise z^2: distances are cut off at three times that, where it is more "
                  "than `truncation`",
                  0.0, 1.0},
            Param{"min_depth", &P::min_depth, "m", "nearer depths are ignored", 0.01, 10.0},
            Param{"max_depth", &P::max_depth, "m", "farther depths are ignored", 0.1, 1000.0},
            Param{"depth_edge", &P::depth_edge, "",
                  "pixels are ignored beside a jump in depth larger than this fraction of the depth", 0.001, 1.0},
            Param{"min_incidence", &P::min_incidence, "",
                  "pixels are ignored where the cosine between ray and surface normal is smaller", 0.0, 1.0},
            Param{"min_weight", &P::min_weight, "",
                  "voxels of less weight make no surface; one frontal observation at 1 m weighs 1, at 2 m 1/4", 0.0,
                  1000.0},
            Param{"min_weight_share", &P::min_weight_share, "",
                  "part of the median weight at the surface; where that is less than min_weight it counts instead, for "
                  "scans of few or distant frames",
                  0.0, 1000.0},
            Param{"min_component_faces", &P::min_component_faces, "", "connected pieces of fewer faces are removed",
                  0.0, 1e9},
            Param{"min_component_area", &P::min_component_area, "m^2", "connected pieces of less area are removed", 0.0,
                  1e3},
            Param{"plausible_extent", &P::plausible_extent, "m",
                  "a larger result is warned about: the depth unit may be wrong", 1.0, 1e6,
                  ParamFlags{.affects_result = false}},
            Param{"memory_limit", &P::memory_limit, "GB", "most memory that the voxels may take", 0.01, 1e6,
                  ParamFlags{.affects_result = false}},
        };
    }
};

// Returns a mesh whose edges have at most two faces and whose vertices have one fan of faces each; faces are
// counter-clockwise seen from the side the cameras were on. Every vertex has a colour if any used frame has one.
// Throws InputError for unreadable images, a changed dense mesh, or params.source = mesh without one; ImpossibleError
// when no used frame has depth or no surface is found; ResourceError naming a voxel size that fits when the memory
// limit is hit.
TriangleMesh fuse(const ScanImages& images, const FuseParams& params);

// Where fuse_frames() gets images: depth [m] (0 = missing, empty = the frame has none) and colour of a frame of the
// scan.
struct FrameSource {
    std::function<DepthImage(FrameId)> depth;
    std::function<ColorImage(FrameId)> color;
};

// The same from the used frames alone. The source is called from several threads.
TriangleMesh fuse_frames(const Scan& scan, const FrameSource& source, const FuseParams& params);

} // namespace quoin
