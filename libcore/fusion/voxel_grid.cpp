#include "fusion/voxel_grid.h"

#include "base/parallel.h"

namespace quoin {
namespace {

// The inverse of spread_bits().
int collect_bits(std::uint64_t v)
{
    v &= 0x1249249249249249;
    v = (v | v >> 2) & 0x10c30c30c30c30c3;
    v = (v | v >> 4) & 0x100f00f00f00f00f;
    v = (v | v >> 8) & 0x1f0000ff0000ff;
    v = (v | v >> 16) & 0x1f00000000ffff;
    return static_cast<int>((v | v >> 32) & 0x1fffff);
}

} // namespace

BlockCoord block_coord(BlockKey key)
{
    const auto unbiased = [](int c) { return c - (1 << 20); };
    return {unbiased(collect_bits(key)), unbiased(collect_bits(key >> 1)), unbiased(collect_bits(key >> 2))};
}

std::size_t VoxelGrid::slot_of(BlockKey key) const
{
    constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15; // Fibonacci hashing (Knuth, vol. 3, 6.4)
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = (key * kGolden >> 32) & mask;
    while (slots_[slot].id != kNoBlock && slots_[slot].key != key)
        slot = (slot + 1) & mask;
    return slot;
}

BlockId VoxelGrid::find(BlockKey key) const { return slots_[slot_of(key)].id; }

void VoxelGrid::grow_table()
{
    std::vector<Slot> old(2 * slots_.size(), Slot{});
    old.swap(slots_);
    for (const Slot& slot : old)
        if (slot.id != kNoBlock) slots_[slot_of(slot.key)] = slot;
}

void VoxelGrid::create(std::span<const BlockKey> keys)
{
    const std::size_t first = size();
    for (const BlockKey key : keys) {
        if (2 * (size() + 1) > slots_.size()) grow_table();
        slots_[slot_of(key)] = {key, static_cast<BlockId>(size())};
        coords_.push_back(block_coord(key));
    }
    while (chunks_.size() * kChunk < size())
        chunks_.push_back(std::make_unique_for_overwrite<VoxelBlock[]>(kChunk));
    constexpr std::size_t kGrain = 64;
    parallel_for(
        keys.size(), [&](std::size_t i) { block(static_cast<BlockId>(first + i)) = VoxelBlock{}; }, kGrain);
}

} // namespace quoin
