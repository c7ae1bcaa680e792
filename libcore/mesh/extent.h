#pragma once

#include <Eigen/Geometry>

namespace quoin {

// Warns of a mesh with a side of more than `plausible` [m]; says how large it would be if it is in millimetres.
void warn_about_extent(const Eigen::AlignedBox3f& box, double plausible);

} // namespace quoin
