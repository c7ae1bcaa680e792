#include "partition/refine_borders.h"

#include "base/parallel.h"
#include "base/progress.h"
#include "geometry/groups.h"
#include "geometry/pca_energy.h"
#include "mesh/adjacency.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <span>

namespace quoin {
namespace {

constexpr std::size_t kMeasureGrain = 1 << 13; // [faces]
constexpr std::size_t kBatchGrain = 1 << 10;

struct RegionFit {
    Moments sum; // about the mesh's centre
    Eigen::Vector3d facing = Eigen::Vector3d::Zero();
    double energy = 0.0;
    std::uint32_t faces = 0;
};

struct Move {
    std::uint32_t to = 0;
    double gain = 0.0; // how much the objective falls [m^4]
};

class Refiner {
public:
    Refiner(const TriangleMesh& mesh, const std::vector<std::uint32_t>& opposite, const RefineLimits& limits,
            std::vector<std::uint32_t>& label)
        : mesh_(mesh), opposite_(opposite), limits_(limits), label_(label),
          border_weight_(border_weight(mesh, limits.border_distance)), origin_(corner(mesh, 0, 0)),
          regions_(1 + *std::max_element(label.begin(), label.end())), place_(label.size(), Place::Out)
    {
        const Groups groups = group_items(label, regions_.size());
        parallel_for(regions_.size(), [&](std::size_t r) { regions_[r] = sum_of(groups.of(r)); });
        queue_ = border_faces();
    }

    // Gains of all faces in the queue are found at once, from the sums of the moment; those that promise something, or
    // whose neighbours have moved meanwhile, are then looked at again one by one.
    void run()
    {
        auto budget = static_cast<std::size_t>(limits_.rounds * static_cast<double>(queue_.size()));
        Progress progress("refining borders", budget);
        std::vector<FaceId> batch;
        while (budget > 0 && !queue_.empty()) {
            batch.swap(queue_);
            queue_.clear();
            batch.resize(std::min(batch.size(), budget));
            mark_promising(batch);
            for (const FaceId f : batch) {
                const bool is_worth_a_look = place_[f] == Place::Promising;
                place_[f] = Place::Out;
                if (is_worth_a_look) try_move(f);
            }
            budget -= batch.size();
            progress.step(batch.size());
        }
        progress.step(budget);
    }

private:
    enum class Place : std::uint8_t { Out, Next, Waiting, Promising }; // out, in queue_, in the batch

    double energy(const Moments& sum) const { return pca_energy(sum, limits_.flat_variance); }
    Moments moments(FaceId f) const
    {
        return triangle_moments(corner(mesh_, f, 0) - origin_, corner(mesh_, f, 1) - origin_,
                                corner(mesh_, f, 2) - origin_);
    }
    // Energy of a region of that many faces; a single face is flat by definition.
    double energy_of(const Moments& sum, std::uint32_t faces) const { return faces < 2 ? 0.0 : energy(sum); }

    RegionFit sum_of(std::span<const FaceId> faces) const
    {
        RegionFit region;
        for (const FaceId f : faces) {
            region.sum += moments(f);
            region.facing += 0.5 * area_vector(mesh_, f);
        }
        region.faces = static_cast<std::uint32_t>(faces.size());
        region.energy = energy(region.sum);
        return region;
    }

    std::vector<FaceId> border_faces()
    {
        const auto found_in = [&](std::size_t begin, std::size_t end) {
            std::vector<FaceId> found;
            for (std::size_t f = begin; f < end; ++f)
                if (on_border(static_cast<FaceId>(f))) found.push_back(static_cast<FaceId>(f));
            return found;
        };
        const auto append = [](std::vector<FaceId> all, const std::vector<FaceId>& more) {
            all.insert(all.end(), more.begin(), more.end());
            return all;
        };
        auto faces = parallel_reduce(label_.size(), kMeasureGrain, std::vector<FaceId>(), found_in, append);
        for (const FaceId f : faces)
            place_[f] = Place::Next;
        return faces;
    }

    void mark_promising(const std::vector<FaceId>& batch)
    {
        parallel_for(
            batch.size(),
            [&](std::size_t i) {
                const FaceId f = batch[i];
                const bool gains = regions_[label_[f]].faces > 1 && best_move(f, moments(f)).gain > 0.0;
                place_[f] = gains ? Place::Promising : Place::Waiting;
            },
            kBatchGrain);
    }

    void try_move(FaceId f)
    {
        if (regions_[label_[f]].faces < 2) return;
        const Moments face = moments(f);
        const Move move = best_move(f, face);
        if (!(move.gain > 0.0) || !stays_connected(f)) return;
        const Eigen::Vector3d facing = 0.5 * area_vector(mesh_, f);
        if (acceptable(face, facing, move.to)) apply(f, move.to, face, facing);
    }

    bool on_border(FaceId f) const
    {
        for (std::uint32_t h = 3 * f; h < 3 * f + 3; ++h)
            if (is_half_edge(opposite_[h]) && label_[opposite_[h] / 3] != label_[f]) return true;
        return false;
    }

    // A face that waits in the present batch is looked at when its turn comes.
    void enqueue(FaceId f)
    {
        if (place_[f] == Place::Waiting) place_[f] = Place::Promising;
        if (place_[f] != Place::Out) return;
        place_[f] = Place::Next;
        queue_.push_back(f);
    }

    double edge_length(std::uint32_t h) const
    {
        return (corner(mesh_, h / 3, static_cast<int>((h % 3 + 1) % 3)) - corner(mesh_, h / 3, static_cast<int>(h % 3)))
            .norm();
    }

    // Length of the face's edges towards a cluster [m].
    double shared_length(FaceId f, std::uint32_t label) const
    {
        double length = 0.0;
        for (std::uint32_t h = 3 * f; h < 3 * f + 3; ++h)
            if (is_half_edge(opposite_[h]) && opposite_[h] / 3 != f && label_[opposite_[h] / 3] == label)
                length += edge_length(h);
        return length;
    }

    // How much the objective falls when a face leaves its region, and when it then joins another one [m^4].
    double gain_of_leaving(FaceId f, const Moments& face) const
    {
        const RegionFit& source = regions_[label_[f]];
        return source.energy - energy_of(source.sum - face, source.faces - 1) -
               border_weight_ * shared_length(f, label_[f]);
    }
    double gain_of_joining(FaceId f, std::uint32_t to, const Moments& face) const
    {
        const RegionFit& target = regions_[to];
        return target.energy - energy(target.sum + face) + border_weight_ * shared_length(f, to);
    }

    Move best_move(FaceId f, const Moments& face) const
    {
        const std::uint32_t from = label_[f];
        const double left = gain_of_leaving(f, face);
        Move best{from, 0.0};
        for (std::uint32_t h = 3 * f; h < 3 * f + 3; ++h) {
            if (!is_half_edge(opposite_[h])) continue;
            const std::uint32_t to = label_[opposite_[h] / 3];
            if (to == from || (to == best.to && best.gain > 0.0)) continue;
            const double gain = left + gain_of_joining(f, to, face);
            if (gain > best.gain || (gain == best.gain && gain > 0.0 && to < best.to)) best = {to, gain};
        }
        return best;
    }

    // Do the neighbours of f in its own cluster hang together without f, going around its corners?
    bool stays_connected(FaceId f) const
    {
        int neighbours = 0, linked = 0;
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t h = opposite_[3 * f + k];
            if (h == kNonManifoldEdge) return false; // a neighbour may hang on this edge
            if (same_cluster(f, h)) ++neighbours;
        }
        for (std::uint32_t k = 0; k < 3; ++k)
            linked += linked_around(f, k);
        return neighbours < 2 || linked >= neighbours - 1;
    }

    bool same_cluster(FaceId f, std::uint32_t half_edge) const
    {
        return is_half_edge(half_edge) && half_edge / 3 != f && label_[half_edge / 3] == label_[f];
    }

    // Can one walk around corner k of f from one neighbour to the other without leaving the cluster?
    bool linked_around(FaceId f, std::uint32_t k) const
    {
        const VertexId pivot = mesh_.face[f][k];
        std::uint32_t entered = opposite_[3 * f + k]; // the half-edge through which the walk came into its face
        const std::uint32_t goal = opposite_[3 * f + (k + 2) % 3];
        if (!same_cluster(f, entered) || !same_cluster(f, goal)) return false;
        for (FaceId g = entered / 3; g != goal / 3;) {
            const std::uint32_t leave = other_edge_at(pivot, entered);
            entered = opposite_[leave];
            if (!same_cluster(f, entered)) return false;
            g = entered / 3;
        }
        return true;
    }

    // The other half-edge of the same face that ends in the vertex.
    std::uint32_t other_edge_at(VertexId v, std::uint32_t h) const
    {
        const std::uint32_t base = h - h % 3, k = h % 3;
        return mesh_.face[h / 3][k] == v ? base + (k + 2) % 3 : base + (k + 1) % 3;
    }

    bool acceptable(const Moments& face, const Eigen::Vector3d& face_facing, std::uint32_t to) const
    {
        const RegionFit& target = regions_[to];
        const Moments sum = target.sum + face;
        const Eigen::Vector3d facing = target.facing + face_facing;
        if (facing.norm() < limits_.min_facing * sum.area) return false;
        if (face_facing.dot(facing) < limits_.min_part_cosine * face_facing.norm() * facing.norm()) return false;
        if (!std::isfinite(limits_.max_error)) return true;
        if (invariants(sum).variance_is_below(limits_.max_error * limits_.max_error)) return true;
        return rms_to_fit(sum) <= std::max(limits_.max_error, rms_to_fit(target.sum));
    }

    void apply(FaceId f, std::uint32_t to, const Moments& face, const Eigen::Vector3d& facing)
    {
        RegionFit &source = regions_[label_[f]], &target = regions_[to];
        source.sum -= face;
        source.facing -= facing;
        source.energy = energy_of(source.sum, --source.faces);
        target.sum += face;
        target.facing += facing;
        target.energy = energy_of(target.sum, ++target.faces);
        label_[f] = to;
        if (on_border(f)) enqueue(f);
        for (std::uint32_t h = 3 * f; h < 3 * f + 3; ++h)
            if (is_half_edge(opposite_[h]) && on_border(opposite_[h] / 3)) enqueue(opposite_[h] / 3);
    }

    const TriangleMesh& mesh_;
    const std::vector<std::uint32_t>& opposite_;
    const RefineLimits& limits_;
    std::vector<std::uint32_t>& label_;
    double border_weight_;
    Eigen::Vector3d origin_;
    std::vector<RegionFit> regions_;
    std::vector<FaceId> queue_;
    std::vector<Place> place_;
};

} // namespace

double border_weight(const TriangleMesh& mesh, double border_distance)
{
    constexpr double kEnergyOfSquare = 144.0; // E = A s^2 / 144
    const auto measure = [&](std::size_t begin, std::size_t end) {
        Eigen::Vector2d sum(0.0, 0.0);
        for (std::size_t f = begin; f < end; ++f) {
            const auto face = static_cast<FaceId>(f);
            sum[0] += face_area(mesh, face);
            for (int k = 0; k < 3; ++k)
                sum[1] += (corner(mesh, face, (k + 1) % 3) - corner(mesh, face, k)).norm();
        }
        return sum;
    };
    const Eigen::Vector2d sum =
        parallel_reduce(mesh.face.size(), kMeasureGrain, Eigen::Vector2d(0.0, 0.0), measure,
                        [](const Eigen::Vector2d& x, const Eigen::Vector2d& y) -> Eigen::Vector2d { return x + y; });
    const double area = sum[0], length = sum[1];
    if (length <= 0.0) return 0.0;
    const double area_per_length = area / (length / 3.0); // mean face over mean edge
    return area_per_length * border_distance * border_distance / kEnergyOfSquare;
}

void refine_borders(const TriangleMesh& mesh, const std::vector<std::uint32_t>& opposite, const RefineLimits& limits,
                    std::vector<std::uint32_t>& label)
{
    if (!mesh.face.empty()) Refiner(mesh, opposite, limits, label).run();
}

} // namespace quoin
