// Colours for the texels that no photograph shows, and for the gutters.
#pragma once

#include "bake/atlas.h"
#include "bake/dense_colors.h"
#include "bake/texel_colors.h"

#include <vector>

namespace quoin {

// A texel of the chart that has colour, next to one that has none.
bool is_rim_of_seen(const TexelChart& texels, const ChartColors& colors, int x, int y);

// Fills unknown pixels (weight 0) smoothly from known ones, by averages over ever larger cells (push-pull, Gortler et
// al. 1996). Known pixels keep their colour. Without any known pixel all become zero.
Image<Eigen::Vector3f> push_pull(const Image<WeightedColor>& known);

// Gives the unseen texels of a chart the colours of the dense mesh, shifted smoothly so that they meet the photographs'
// along the border of what was seen.
void fill_from_dense(const PlaneMesh& planes, const TexelChart& texels, const DenseColors& dense, ChartColors& colors);

// Fills the other texels from within their chart, and charts without any colour from what those around show where they
// touch, else from the mean of all. Gutters continue the chart. Afterwards every texel of every rectangle has colour.
void fill_rest(const PlaneMesh& planes, const Atlas& atlas, std::vector<ChartColors>& colors);

} // namespace quoin
