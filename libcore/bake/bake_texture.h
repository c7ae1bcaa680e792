// Final textures: charts, atlas and the colours of all texels, from the photographs first, from the dense mesh where no
// photograph sees, and from what is around where nothing does.
#pragma once

#include "base/param.h"
#include "mesh/plane_mesh.h"
#include "mesh/textured_mesh.h"
#include "scan/alignment.h"
#include "scan/keyframes.h"
#include "scan/scan.h"

#include <array>
#include <tuple>

namespace quoin {

// Mean: the plain average of all views (Wang & Guo 2019). BestView: every tile from its best views, feathered. TwoBand:
// coarse colours from all views, detail from the best ones.
enum class Blend { Mean, BestView, TwoBand };
constexpr auto choice_names(Blend) { return std::array{"mean", "best-view", "two-band"}; }

enum class PageFormat { Jpeg, Png };
constexpr auto choice_names(PageFormat) { return std::array{"jpeg", "png"}; }

struct BakeTextureParams {
    Blend blend = Blend::TwoBand;
    double density = 300.0;
    double min_density = 150.0;
    double max_density = 800.0;
    double supersampling = 1.15;
    double max_megatexels = 32.0;
    int max_page_size = 4096;
    int clean_mip_levels = 1;
    double max_view_angle = 78.0;
    double min_depth = 0.3;
    double max_depth = 8.0;
    double depth_tolerance = 0.03;
    double depth_noise = 0.0015;
    double depth_jump = 0.05;
    double edge_margin = 3.0;
    double edge_feather = 16.0;
    bool last_views = true;
    double last_view_angle = 85.0;
    double consistency = 8.0;
    double label_smoothness = 0.5;
    double band_width = 0.02;
    double detail_quality = 0.9;
    double residual_shift = 2.0;
    double dense_radius = 0.05;
    double seam_width = 0.1;
    double seam_step = 25.0;
    PageFormat format = PageFormat::Jpeg;
    int jpeg_quality = 92;

    static constexpr auto list()
    {
        using P = BakeTextureParams;
        return std::tuple{
            Param{"blend", &P::blend, "", "how the views of a texel become one colour"},
            Param{"density", &P::density, "1/m",
                  "texels per metre of charts that no view measures; longer charts than a page are not made coarser "
                  "than this before they are cut",
                  1.0, 10000.0},
            Param{"min_density", &P::min_density, "1/m", "least texels per metre of a chart", 1.0, 10000.0},
            Param{"max_density", &P::max_density, "1/m", "most texels per metre of a chart", 1.0, 10000.0},
            Param{"supersampling", &P::supersampling, "", "texels per pixel of a chart's best views", 0.1, 4.0},
            Param{"max_megatexels", &P::max_megatexels, "10^6",
                  "texels of all pages together; every chart is made coarser until they fit", 0.01, 1000.0},
            Param{"max_page_size", &P::max_page_size, "px",
                  "longest side of an atlas page, rounded down to a multiple of 4 and of 2^clean_mip_levels", 64,
                  16384},
            Param{"clean_mip_levels", &P::clean_mip_levels, "",
                  "mip levels, each half as large as the one before, in which charts do not bleed into each other: how "
                  "wide the gutters are",
                  1, 5},
            Param{"max_view_angle", &P::max_view_angle, "deg",
                  "views that look at a surface more obliquely are not used; faces that turn further from their plane "
                  "get charts of their own",
                  10.0, 85.0},
            Param{"min_depth", &P::min_depth, "m", "nearest surface that a view is used for", 0.0, 10.0},
            Param{"max_depth", &P::max_depth, "m", "farthest surface that a view is used for", 0.1, 1000.0},
            Param{"depth_tolerance", &P::depth_tolerance, "m",
                  "largest distance between a surface and the measured depth of a view that sees it", 0.001, 1.0},
            Param{"depth_noise", &P::depth_noise, "1/m",
                  "standard deviation of the sensor's depth over its square; the tolerance is at least three of them",
                  0.0, 1.0},
            Param{"depth_jump", &P::depth_jump, "m", "step of depth between neighbouring pixels that is an edge", 0.001,
                  10.0},
            Param{"edge_margin", &P::edge_margin, "px",
                  "pixels of a view this near to an edge of depth or to the image border are not used", 1.0, 100.0},
            Param{"edge_feather", &P::edge_feather, "px", "width over which a view's weight falls towards such an edge",
                  0.0, 1000.0},
            Param{"last_views", &P::last_views, "",
                  "colour what no view shows within edge_margin and max_view_angle from the best that shows it at all"},
            Param{"last_view_angle", &P::last_view_angle, "deg", "how obliquely the last views may look at a surface",
                  10.0, 89.0},
            Param{"consistency", &P::consistency, "",
                  "deviation from the other views of a tile, in grey levels, at which a view's weight falls to 0.6",
                  0.5, 1000.0},
            Param{"label_smoothness", &P::label_smoothness, "",
                  "cost of a change of the best view between neighbouring tiles, as the logarithm of a ratio of "
                  "qualities",
                  0.0, 100.0},
            Param{"band_width", &P::band_width, "m",
                  "size above which colours come from all views, below which they come from the best ones (two-band)",
                  0.001, 1.0},
            Param{"detail_quality", &P::detail_quality, "",
                  "views of a tile whose quality and consistency are at least this share of the best one's lend "
                  "detail too, which lowers noise; 1 = the best one only",
                  0.0, 1.0},
            Param{"residual_shift", &P::residual_shift, "texel",
                  "farthest that a view is shifted on a part of a chart so that its detail meets the mean of the views",
                  0.0, 16.0},
            Param{"dense_radius", &P::dense_radius, "m",
                  "farthest vertex of the dense mesh that colours an unseen texel", 0.001, 1.0},
            Param{"seam_width", &P::seam_width, "m",
                  "width over which a step of brightness between charts is faded out; 0 = leave it", 0.0, 10.0},
            Param{"seam_step", &P::seam_step, "",
                  "steps between charts of more grey levels are changes of material and stay", 0.5, 1000.0},
            Param{"format", &P::format, "", "encoding of the pages"},
            Param{"jpeg_quality", &P::jpeg_quality, "", "quality of JPEG pages, without chroma subsampling", 1, 100},
        };
    }
};

// What textures are baked from; all of it outlives the baking.
struct BakeInput {
    const ScanImages& images;
    const Keyframes& keyframes;
    const PlaneMesh& planes;
    const Alignment& alignment;
    const TriangleMesh* dense = nullptr; // optional; its vertex colours go to what no view sees
};

// Every face of the result has colour and a place of its own on a page. Throws InputError when the keyframes, the
// alignment and the plane mesh do not belong together or an image cannot be read, ImpossibleError when the mesh has no
// faces.
TexturedMesh bake_texture(const BakeInput& input, const BakeTextureParams& params);

} // namespace quoin
