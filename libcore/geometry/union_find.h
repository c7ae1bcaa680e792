#pragma once

#include <cstdint>
#include <numeric>
#include <vector>

namespace quoin {

// Disjoint sets of 0..n-1 with path halving. The caller chooses the root, so that it can keep its sums there.
class UnionFind {
public:
    explicit UnionFind(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }
    std::uint32_t find(std::uint32_t i)
    {
        while (parent_[i] != i)
            i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    std::uint32_t root(std::uint32_t i) const // find(), for several threads at once
    {
        while (parent_[i] != i)
            i = parent_[i];
        return i;
    }
    void join(std::uint32_t root, std::uint32_t child_root) { parent_[child_root] = root; }
    bool is_root(std::uint32_t i) const { return parent_[i] == i; }

private:
    std::vector<std::uint32_t> parent_;
};

} // namespace quoin
