#pragma once

#include "fusion/depth_view.h"
#include "fusion/padded_depth.h"

namespace quoin {

// Gives every kept depth pixel of the view the colour that the colour camera sees at its point, unless something hides
// the point there. `measured` has all depths within range, those that the view dropped too: they hide what is behind.
void register_color(const Scan& scan, const PaddedDepth& measured, const ColorImage& color, const ViewParams& params,
                    DepthView& view);

} // namespace quoin
