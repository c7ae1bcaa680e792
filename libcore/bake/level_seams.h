// Steps of brightness between charts, faded out.
#pragma once

#include "bake/atlas.h"
#include "bake/texel_colors.h"

#include <vector>

namespace quoin {

struct SeamOptions {
    double width = 0.0;   // over which a step is faded out on either side [m]
    double segment = 0.0; // length of border over which a step is averaged, so that detail is not taken for a step [m]
    double step = 0.0;    // grey levels above which a step is rather a change of material and stays
};

// Along every edge between two charts both show the same points, so the mean difference of their colours there is an
// error of exposure or shading. Half of it is taken from either side, fading to nothing over `width`: what Waechter et
// al. (2014) do by one linear system over the vertices, done here on the texels, for faces here are as large as walls.
void level_seams(const PlaneMesh& planes, const Atlas& atlas, const SeamOptions& options,
                 std::vector<ChartColors>& colors);

} // namespace quoin
