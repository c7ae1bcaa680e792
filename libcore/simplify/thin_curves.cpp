#include "simplify/thin_curves.h"

#include "base/parallel.h"

#include <functional>
#include <queue>
#include <tuple>

namespace quoin {
namespace {

constexpr std::size_t kCurveGrain = 16; // [curves]

struct CurveContraction {
    double cost = 0.0;
    std::uint32_t first = 0, second = 0; // slots of the edge
    std::uint32_t first_version = 0, second_version = 0;

    bool operator>(const CurveContraction& other) const
    {
        return std::tie(cost, first, second) > std::tie(other.cost, other.first, other.second);
    }
};

// What is one per slot is shared by all curves, each of which touches its own.
struct SlotState {
    std::vector<Quadric> quadric;
    std::vector<std::uint32_t> version;
};

class CurveThinner {
public:
    CurveThinner(const CurveFit& fit, const CurveBounds& bounds, SlotState& slots, Curves& curves,
                 std::vector<Eigen::Vector3d>& position)
        : fit_(fit), bounds_(bounds), slots_(slots), curves_(curves), position_(position)
    {
    }

    void run(CurveId id)
    {
        Curve& curve = curves_.curve[id];
        for (std::uint32_t s = curve.first; s < curve.first + curve.count; ++s)
            slots_.quadric[s] = {};
        fit_.add_quadrics(curve, slots_.quadric);
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
        for_each_edge(curve, [&](std::uint32_t s) { push(s); });
        while (!heap_.empty() && edges_ > least_edges) {
            const CurveContraction best = heap_.top();
            heap_.pop();
            if (slots_.version[best.first] == best.first_version && slots_.version[best.second] == best.second_version)
                try_join(curve, best.first, best.second);
        }
        heap_ = {};
    }

    void push(std::uint32_t first)
    {
        const std::uint32_t second = curves_.next[first];
        if (second == Curves::kNone || (fit_.corner(first) && fit_.corner(second))) return;
        heap_.push(
            {fit_.cost(first, second, slots_.quadric), first, second, slots_.version[first], slots_.version[second]});
    }

    void try_join(Curve& curve, std::uint32_t s, std::uint32_t t)
    {
        for (const Eigen::Vector3d& x : {fit_.target(s, t, slots_.quadric), fit_.position(s), fit_.position(t)}) {
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
        slots_.quadric[kept] += slots_.quadric[gone];
        ++slots_.version[gone];
        ++slots_.version[kept];
        --edges_;
        if (curves_.previous[kept] != Curves::kNone) push(curves_.previous[kept]);
        push(kept);
    }

    const CurveFit& fit_;
    const CurveBounds& bounds_;
    SlotState& slots_;
    Curves& curves_;
    std::vector<Eigen::Vector3d>& position_;
    std::priority_queue<CurveContraction, std::vector<CurveContraction>, std::greater<>> heap_;
    std::size_t edges_ = 0; // left
};

} // namespace

void thin_curves(const CurveFit& fit, std::span<const CurveId> which, const CurveBounds& bounds, Curves& curves,
                 std::vector<Eigen::Vector3d>& position)
{
    SlotState slots{std::vector<Quadric>(curves.size()), std::vector<std::uint32_t>(curves.size(), 0)};
    parallel_chunks(which.size(), kCurveGrain, [&](std::size_t begin, std::size_t end) {
        CurveThinner thinner(fit, bounds, slots, curves, position);
        for (std::size_t i = begin; i < end; ++i)
            thinner.run(which[i]);
    });
}

} // namespace quoin
