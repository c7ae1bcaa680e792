// Charts: connected pieces of the mesh that face one side, laid flat without stretching.
#pragma once

#include "mesh/plane_mesh.h"

#include <Eigen/Core>
#include <vector>

namespace quoin {

// Chart coordinates are metres along axis_u and axis_v from `origin`; seen from the front, u runs right and v runs
// down, as in an image. All faces lie in [0, extent]; none is turned over.
struct Chart {
    PlaneId plane = 0;
    std::vector<FaceId> face; // ascending
    Eigen::Vector3d origin = Eigen::Vector3d::Zero(), axis_u = Eigen::Vector3d::UnitX(),
                    axis_v = Eigen::Vector3d::UnitY();
    Eigen::Vector2d extent = Eigen::Vector2d::Zero(); // [m]
    double density = 0.0;                             // texels per metre

    Eigen::Vector3d normal() const { return axis_v.cross(axis_u); } // towards the front
    Eigen::Vector2d from_world(const Eigen::Vector3d& p_world) const
    {
        return {axis_u.dot(p_world - origin), axis_v.dot(p_world - origin)};
    }
};

// One chart per connected piece of a plane whose faces turn towards the front of the plane; the other faces of the
// plane (folded over, or steeper than min_facing) get charts that face their own way. min_facing is the least cosine
// between a face and its chart. Every face is in exactly one chart; density is left 0.
std::vector<Chart> make_charts(const PlaneMesh& planes, double min_facing);

// Takes out of every chart the faces that would lie over others of it, at the chart's density, into charts of their
// own.
void split_overlaps(const PlaneMesh& planes, std::vector<Chart>& charts);

// Lowers the density of charts that are longer than `max_texels`, down to `least_density`; halves those still too long
// as often as it takes. A single face that is still too long keeps the density at which it fits.
void fit_charts(const PlaneMesh& planes, std::vector<Chart>& charts, int max_texels, double least_density);

// Turns the chart by a right angle, so that its height becomes its width.
void turn(Chart& chart);

} // namespace quoin
