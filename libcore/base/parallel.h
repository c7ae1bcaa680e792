// The one way to run in parallel. The same bytes come out for any number of threads: work is cut into chunks that do
// not depend on the thread count, every item writes its own slot, and reductions run over chunks in order.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace quoin {

// Threads that parallel_for may use; 0 = all that the machine has.
void set_thread_count(int threads);
int thread_count();

// Calls body(begin, end) for consecutive chunks of `grain` items that cover [0, count). An exception of a chunk is
// rethrown.
void parallel_chunks(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body);

// Calls body(i) for every i in [0, count).
template <class Body>
void parallel_for(std::size_t count, const Body& body, std::size_t grain = 1)
{
    parallel_chunks(count, grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            body(i);
    });
}

// Runs tasks that do not depend on each other.
template <class... Tasks>
void parallel_tasks(const Tasks&... tasks)
{
    const std::array<std::function<void()>, sizeof...(Tasks)> all{tasks...};
    parallel_for(all.size(), [&](std::size_t i) { all[i](); });
}

// Folds chunks in order: result = combine(... combine(identity, chunk_0) ..., chunk_n), where chunk = map(begin, end).
template <class Value, class Map, class Combine>
Value parallel_reduce(std::size_t count, std::size_t grain, Value identity, const Map& map, const Combine& combine)
{
    if (count == 0) return identity;
    std::vector<Value> partial((count + grain - 1) / grain, identity);
    parallel_chunks(count, grain,
                    [&](std::size_t begin, std::size_t end) { partial[begin / grain] = map(begin, end); });
    Value total = std::move(identity);
    for (auto& value : partial)
        total = combine(std::move(total), std::move(value));
    return total;
}

// Does keep(i) hold for every i in [0, count)?
template <class Keep>
bool parallel_all_of(std::size_t count, std::size_t grain, const Keep& keep)
{
    const auto all = [&](std::size_t begin, std::size_t end) {
        while (begin < end && keep(begin))
            ++begin;
        return std::uint8_t(begin == end);
    };
    return parallel_reduce(count, grain, std::uint8_t{1}, all, std::bit_and<std::uint8_t>()) != 0;
}

// The i in [0, count) for which keep(i) holds, ascending.
template <class Index, class Keep>
std::vector<Index> parallel_select(std::size_t count, std::size_t grain, const Keep& keep)
{
    const auto select = [&](std::size_t begin, std::size_t end) {
        std::vector<Index> chosen;
        for (; begin < end; ++begin)
            if (keep(begin)) chosen.push_back(static_cast<Index>(begin));
        return chosen;
    };
    const auto append = [](std::vector<Index> all, const std::vector<Index>& more) {
        all.insert(all.end(), more.begin(), more.end());
        return all;
    };
    return parallel_reduce(count, grain, std::vector<Index>(), select, append);
}

} // namespace quoin
