// Items by the group that each belongs to, in one array: faces by plane, vertices by cluster.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace quoin {

inline constexpr std::uint32_t kNoGroup = 0xffffffffu; // as kNoPlane

struct Groups {
    std::vector<std::uint32_t> first; // groups + 1
    std::vector<std::uint32_t> item;  // ascending in every group
    std::span<const std::uint32_t> of(std::size_t group) const
    {
        return {item.data() + first[group], first[group + 1] - first[group]};
    }
};

// group_of: of every item one below `groups`, or kNoGroup for items to leave out.
Groups group_items(const std::vector<std::uint32_t>& group_of, std::size_t groups);

} // namespace quoin
