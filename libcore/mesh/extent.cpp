#include "mesh/extent.h"

#include "base/log.h"

#include <fmt/format.h>

namespace quoin {
namespace {

std::string size_text(const Eigen::Vector3f& size)
{
    return fmt::format("{:.1f} x {:.1f} x {:.1f} m", size.x(), size.y(), size.z());
}

} // namespace

void warn_about_extent(const Eigen::AlignedBox3f& box, double plausible)
{
    constexpr float kMetresPerMillimetre = 1e-3f;
    if (box.isEmpty() || static_cast<double>(box.sizes().maxCoeff()) <= plausible) return;
    log_warning(fmt::format("the mesh is {} large: check the depth unit and the poses of the scan; a mesh in "
                            "millimetres is to be scaled by {}, to {}",
                            size_text(box.sizes()), kMetresPerMillimetre,
                            size_text(kMetresPerMillimetre * box.sizes())));
}

} // namespace quoin
