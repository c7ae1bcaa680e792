#include "geometry/groups.h"

namespace quoin {

Groups group_items(const std::vector<std::uint32_t>& group_of, std::size_t groups)
{
    Groups result{std::vector<std::uint32_t>(groups + 1, 0), {}};
    for (const std::uint32_t group : group_of)
        if (group != kNoGroup) ++result.first[group + 1];
    for (std::size_t g = 0; g < groups; ++g)
        result.first[g + 1] += result.first[g];
    result.item.resize(result.first.back());
    std::vector<std::uint32_t> next(result.first.begin(), result.first.end() - 1);
    for (std::uint32_t i = 0; i < group_of.size(); ++i)
        if (group_of[i] != kNoGroup) result.item[next[group_of[i]]++] = i;
    return result;
}

} // namespace quoin
