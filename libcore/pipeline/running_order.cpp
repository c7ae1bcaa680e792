#include "pipeline/running_order.h"

#include <algorithm>
#include <functional>
#include <queue>

namespace quoin {

// Kahn's algorithm.
std::vector<std::size_t> running_order(const Waits& waits)
{
    Waits followers(waits.size());
    std::vector<std::size_t> missing(waits.size());
    std::priority_queue<std::size_t, std::vector<std::size_t>, std::greater<>> ready;
    for (std::size_t i = 0; i < waits.size(); ++i) {
        missing[i] = waits[i].size();
        if (missing[i] == 0) ready.push(i);
        for (const std::size_t before : waits[i])
            followers[before].push_back(i);
    }
    std::vector<std::size_t> order;
    while (!ready.empty()) {
        order.push_back(ready.top());
        ready.pop();
        for (const std::size_t follower : followers[order.back()])
            if (--missing[follower] == 0) ready.push(follower);
    }
    return order;
}

std::vector<std::vector<std::size_t>> find_circles(const Waits& waits, const std::vector<std::size_t>& order)
{
    enum class Mark { Unseen, OnPath, Left, Placed };
    std::vector<Mark> marks(waits.size(), Mark::Unseen);
    for (const std::size_t placed : order)
        marks[placed] = Mark::Placed;
    std::vector<std::vector<std::size_t>> circles;
    for (std::size_t start = 0; start < waits.size(); ++start) {
        // What could not be placed waits for something that could not be placed: the walk ends on a circle or at a
        // place where an earlier walk was.
        std::vector<std::size_t> path;
        std::size_t at = start;
        while (marks[at] == Mark::Unseen) {
            marks[at] = Mark::OnPath;
            path.push_back(at);
            at = *std::ranges::find_if(waits[at], [&](std::size_t before) { return marks[before] != Mark::Placed; });
        }
        if (!path.empty() && marks[at] == Mark::OnPath) {
            std::vector<std::size_t> circle(std::ranges::find(path, at), path.end());
            circle.push_back(at);
            std::ranges::reverse(circle);
            circles.push_back(std::move(circle));
        }
        for (const std::size_t seen : path)
            marks[seen] = Mark::Left;
    }
    return circles;
}

} // namespace quoin
