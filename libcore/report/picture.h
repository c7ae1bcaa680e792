// A picture of an artifact: what a person wants to see of it at once.
#pragma once

#include "image/image.h"
#include "mesh/line_matches.h"
#include "mesh/textured_mesh.h"
#include "scan/alignment.h"
#include "scan/keyframes.h"
#include "scan/scan.h"

namespace quoin {

struct PictureSize {
    int width = 1280; // [px]
    int height = 960; // [px]
    int columns = 3;  // of photographs side by side
    int photographs = 9;
};

// A mesh from above one corner, seen through its outer walls: with vertex colours, colours by plane, or textures.
ColorImage picture_of(const TriangleMesh& mesh, const PictureSize& size = {});
ColorImage picture_of(const PlaneMesh& mesh, const PictureSize& size = {});
ColorImage picture_of(const TexturedMesh& mesh, const PictureSize& size = {});

// Evenly chosen frames or keyframes of a scan, side by side.
ColorImage picture_of(const Scan& scan, const ScanImages& images, const PictureSize& size = {});
ColorImage picture_of(const Keyframes& keyframes, const ScanImages& images, const PictureSize& size = {});

// The keyframes with most matches, with their segments (orange) and the fitted ends of the borders in the scan's poses
// (blue). Throws ImpossibleError when there is no match and InputError when a frame is not in the scan.
ColorImage picture_of(const LineMatches& lines, const ScanImages& images, const PictureSize& size = {});

// The energies over their rounds, each relative to its largest value, above the path of the cameras seen along the
// direction in which it is flattest.
ColorImage picture_of(const Alignment& alignment, const PictureSize& size = {});

} // namespace quoin
