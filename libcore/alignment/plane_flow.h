// How a frame's picture of a plane moves with the unknowns. A plane is seen by a homography: with r = (x, y, 1) the
// place (X/Z, Y/Z) of a point X of the plane, any step moves it by dX/Z = F r, with one 3x3 flow F for all points. So
// the derivatives of a grey by poses, planes and calibration are all linear in the eight numbers that F has.
#pragma once

#include "alignment/state.h"

namespace quoin {

// A step of the colour camera alone: turn, shift, relative focal length, principal point in units of it. The steps of
// the depth camera's pose and of the calibration both come down to one.
using CameraStep = Eigen::Matrix<double, 9, 1>;

// The colour camera of one frame: from steps of its unknowns to its own.
struct CameraFlow {
    Rigid color_from_depth;
    double fx = 1.0, fy = 1.0; // [px], full size

    CameraStep step(const Twist& pose, const CalibrationStep& calibration) const;
    // Its transposes.
    Twist pose_gradient(const CameraStep& gradient) const;
    CalibrationStep calibration_gradient(const CameraStep& gradient) const;
    // B with step(pose, 0) = (B pose, 0).
    Eigen::Matrix<double, 6, 6> by_pose() const;
};
CameraFlow camera_flow(const ColorCamera& color);

// A plane as one frame's colour camera sees it: 1/Z = inverse_depth . r.
struct PlaneFlow {
    Vector3 inverse_depth = Vector3::Zero();
    Vector3 normal = Vector3::Zero(), center = Vector3::Zero();
    TangentBasis tangents = TangentBasis::Zero();

    // F of a step of the camera and a step (alpha, s) of the plane. Points glide along their plane by their distance to
    // it times alpha, too; that is of second order, and left out.
    Eigen::Matrix3d flow(const CameraStep& camera, const Vector3& plane) const;
    // Gradients of <S, F>.
    CameraStep camera_gradient(const Eigen::Matrix3d& S) const;
    Vector3 plane_gradient(const Eigen::Matrix3d& S) const;
};
// No flow at all for a plane that passes through the camera.
PlaneFlow plane_flow(const Rigid& color_from_world, const CenteredPlane& plane);

} // namespace quoin
