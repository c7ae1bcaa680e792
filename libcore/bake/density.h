// How many texels a metre of every chart deserves: as many as the photographs have pixels there.
#pragma once

#include "bake/bake_texture.h"
#include "bake/charts.h"

namespace quoin {

// Sets the density of every chart to the resolution of its best views (the median of the three sharpest of those that
// see a good part of it), times `supersampling`, within [min_density, max_density]; unseen charts get the nominal
// density.
void set_densities(std::vector<Chart>& charts, const PlaneMesh& planes, const Alignment& alignment,
                   const BakeTextureParams& params);

} // namespace quoin
