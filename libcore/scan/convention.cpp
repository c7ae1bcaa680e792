#include "scan/convention.h"

namespace quoin {

Rigid camera_from_world(const Eigen::Matrix4d& listed, const PoseConvention& convention)
{
    const Rigid pose = orthonormalized(Rigid(listed));
    Rigid world_from_camera = convention.world_to_camera ? pose.inverse() : pose;
    if (convention.y_up_z_back)
        world_from_camera.linear() = world_from_camera.linear() * Eigen::DiagonalMatrix<double, 3>(1.0, -1.0, -1.0);
    if (convention.flip_y) {
        const Eigen::DiagonalMatrix<double, 3> F(1.0, -1.0, 1.0);
        world_from_camera.linear() = F * world_from_camera.linear() * F;
        world_from_camera.translation() = F * world_from_camera.translation();
    }
    return world_from_camera.inverse();
}

} // namespace quoin
