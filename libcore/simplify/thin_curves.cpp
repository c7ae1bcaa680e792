#include "simplify/thin_curves.h"

#include "base/parallel.h"

#include <functional>
#include <queue>
#include <tuple>

namespace quoin {
namespace {

constexpr std::size_t kCurveGrain = 4;  // [curves]
constexpr std::size_t kCostGrain = 256; // [edges]

struct CurveContraction {
    double cost = 0.0;
    std::uint32_t first = 0, second = 0; // slots of the edge
    std::uint32_t first_version = 0, second_version = 0;

    bool operator>(const CurveContraction& other) const
    {
        return std::tie(cost, first, second) > std::tie(other.cost, other.first, other.second);
    }
};

class OneCurveThinner {
    using Heap = std::priority_queue<CurveContraction, std::vector<CurveContraction>, std::greater<>>;

public:
    OneCurveThinner(const CurveFit& fit, const CurveBounds& bounds, std::vector<Quadric>& quadric,
                    std::vector<Eigen::Vector3d>& target, std::vector<std::uint32_t>& version, Curves& curves,
                    std::vector<Eigen::Vector3d>& position)
        : fit_(fit), bounds_(bounds), quadric_(quadric), target_(target), version_(version), curves_(curves),
          position_(position)
    {
    }

    void run(CurveId id)
    {
        Curve& curve = curves_.curve[id];
        for (std::uint32_t s = curve.first; s < curve.first + curve.count; ++s)
            quadric_[s] = {};
        fit_.add_quadrics(curve, quadric_);
        edges_ = 0;
        for_each_edge(curve, [&](std::uint32_t) { ++edges_; });
        // Joins make room for others that were refused before.
        for (std::size_t before = edges_ + 1; edges_ < before && edges_ > bounds_.least_edges[id];) {
            before = edges_;
            join_all(curve, bounds_.least_edges[id]);
        }
    }

private:
    template <class Visit>
    void for_each_edge(const Curve& curve, const Visit& visit) const
    {
        for (std::uint32_t s = curve.head; curves_.next[s] != Curves::kNone;) {
            visit(s);
            s = curves_.next[s];
            if (s == curve.head) break;
        }
    }

    void join_all(Curve& curve, std::size_t least_edges)
    {
        push_all(curve);
        while (!heap_.empty() && edges_ > least_edges) {
            const CurveContraction best = heap_.top();
            heap_.pop();
            if (version_[best.first] == best.first_version && version_[best.second] == best.second_version)
                try_join(curve, best.first, best.second);
        }
        heap_ = {};
    }

    // Those of one long curve in parallel: few others are left when its turn comes again and again.
    void push_all(const Curve& curve)
    {
        std::vector<CurveContraction> all;
        for_each_edge(curve, [&](std::uint32_t s) {
            if (may_join(s)) all.push_back({0.0, s, curves_.next[s], version_[s], version_[curves_.next[s]]});
        });
        parallel_for(
            all.size(), [&](std::size_t i) { all[i].cost = evaluate(all[i].first); }, kCostGrain);
        heap_ = Heap(std::greater<>(), std::move(all));
    }

    bool may_join(std::uint32_t first) const
    {
        const std::uint32_t second = curves_.next[first];
        return second != Curves::kNone && !(fit_.corner(first) && fit_.corner(second));
    }

    // Finds where the ends of an edge go when they are joined. Returns what that costs.
    double evaluate(std::uint32_t first)
    {
        const std::uint32_t second = curves_.next[first];
        target_[first] = fit_.target(first, second, quadric_);
        return fit_.cost(first, second, target_[first], quadric_);
    }

    void push(std::uint32_t first)
    {
        if (!may_join(first)) return;
        const std::uint32_t second = curves_.next[first];
        heap_.push({evaluate(first), first, second, version_[first], version_[second]});
    }

    void try_join(Curve& curve, std::uint32_t s, std::uint32_t t)
    {
        for (const Eigen::Vector3d& x : {target_[s], fit_.position(s), fit_.position(t)}) {
            const bool moves_corner =
                (fit_.corner(s) && x != fit_.position(s)) || (fit_.corner(t) && x != fit_.position(t));
            if (moves_corner || !fit_.fits(s, t, x, &bounds_.tolerance)) continue;
            return join(curve, s, t, x);
        }
    }

    void join(Curve& curve, std::uint32_t s, std::uint32_t t, const Eigen::Vector3d& x)
    {
        const bool keep_second = fit_.corner(t);
        const std::uint32_t kept = keep_second ? t : s, gone = keep_second ? s : t;
        if (!fit_.corner(kept)) position_[curves_.vertex[kept]] = x; // a corner is other curves' too
        const std::uint32_t previous = curves_.previous[gone], next = curves_.next[gone];
        if (previous != Curves::kNone) curves_.next[previous] = next;
        if (next != Curves::kNone) curves_.previous[next] = previous;
        curves_.next[gone] = curves_.previous[gone] = Curves::kNone;
        if (gone == curve.head) curve.head = kept;
        quadric_[kept] += quadric_[gone];
        ++version_[gone];
        ++version_[kept];
        --edges_;
        if (curves_.previous[kept] != Curves::kNone) push(curves_.previous[kept]);
        push(kept);
    }

    const CurveFit& fit_;
    const CurveBounds& bounds_;
    std::vector<Quadric>& quadric_;        // one per slot
    std::vector<Eigen::Vector3d>& target_; // one per slot, of the edge that begins there
    std::vector<std::uint32_t>& version_;  // one per slot
    Curves& curves_;
    std::vector<Eigen::Vector3d>& position_;
    Heap heap_;
    std::size_t edges_ = 0; // left
};

} // namespace

CurveThinner::CurveThinner(const PlaneMesh& planes, Curves& curves, std::vector<Eigen::Vector3d>& position,
                           const SimplifyParams& params)
    : curves_(curves), position_(position), fit_(planes, curves, position, params), quadric_(curves.size()),
      target_(curves.size()), version_(curves.size(), 0)
{
}

void CurveThinner::thin(std::span<const CurveId> which, const CurveBounds& bounds)
{
    parallel_chunks(which.size(), kCurveGrain, [&](std::size_t begin, std::size_t end) {
        OneCurveThinner thinner(fit_, bounds, quadric_, target_, version_, curves_, position_);
        for (std::size_t i = begin; i < end; ++i)
            thinner.run(which[i]);
    });
}

} // namespace quoin
