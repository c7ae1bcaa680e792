#include "fusion/typical_weight.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace quoin {
namespace {

constexpr BlockId kEveryBlock = 7; // the median of one block in so many is near enough

} // namespace

double typical_surface_weight(const VoxelGrid& grid, double truncation)
{
    const auto reach = static_cast<int>(std::min(1.0, 0.5 * grid.voxel_size() / truncation) * kDistanceScale);
    std::vector<float> weights;
    for (BlockId id = 0; id < grid.size(); id += kEveryBlock) {
        const VoxelBlock& block = grid.block(id);
        for (std::size_t i = 0; i < kBlockVoxels; ++i)
            if (block.weight[i] > 0.0f && std::abs(static_cast<int>(block.distance[i])) <= reach)
                weights.push_back(block.weight[i]);
    }
    if (weights.empty()) return 0.0;
    const auto middle = weights.begin() + static_cast<std::ptrdiff_t>(weights.size() / 2);
    std::nth_element(weights.begin(), middle, weights.end());
    return *middle;
}

} // namespace quoin
