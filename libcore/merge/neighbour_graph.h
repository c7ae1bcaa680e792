// Clusters, the lengths of their common borders, and joins that cost O(1) in faces.
#pragma once

#include "mesh/border_strip.h"

#include <map>
#include <vector>

namespace quoin {

class NeighbourGraph {
public:
    struct Cluster {
        Moments sum;                                      // about the graph's origin
        Eigen::Vector3d facing = Eigen::Vector3d::Zero(); // sum of the clusters' normals, times area [m^2]
        Plane plane;                                      // least squares, oriented by `facing`; about the origin
        double energy = 0.0;                              // of `sum` [m^4]
        double mesh_border = 0.0;                         // [m]
        std::uint32_t version = 0;                        // changes with every join
    };
    using Borders =
        std::map<PlaneId, double>; // neighbour -> length of the common border [m]; ordered, for equal results

    NeighbourGraph(const PlaneMesh& mesh, const BorderStrip& strip);

    std::size_t size() const { return clusters_.size(); }
    bool is_alive(PlaneId c) const { return parent_[c] == c; }
    const Cluster& cluster(PlaneId c) const { return clusters_[c]; }
    const Borders& borders(PlaneId c) const { return borders_[c]; }
    double energy(const Moments& sum) const;

    // `from` becomes a part of `into`; both must be alive.
    void join(PlaneId into, PlaneId from);

    // The living cluster that each one is a part of.
    std::vector<PlaneId> roots() const;

private:
    void add_borders(const BorderStrip& strip);
    void refresh(Cluster& cluster) const;

    std::vector<Cluster> clusters_;
    std::vector<Borders> borders_;
    std::vector<PlaneId> parent_;
    double flat_variance_ = 0.0; // [m^2]
};

} // namespace quoin
