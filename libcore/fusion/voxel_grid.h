// Blocks of 8^3 voxels, created where a surface was seen.
#pragma once

#include "mesh/morton.h"

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace quoin {

inline constexpr int kBlockSide = 8; // [voxels]
inline constexpr int kBlockVoxels = kBlockSide * kBlockSide * kBlockSide;

// Walls of drawn rooms lie at round coordinates. A lattice that does too would find distances of zero, with random
// signs.
inline constexpr double kLatticeOffset = 0.382; // [voxels]

using BlockCoord = Eigen::Vector3i; // [blocks]
using BlockKey = std::uint64_t;     // Morton code of the coordinates
using BlockId = std::uint32_t;      // in order of creation
inline constexpr BlockId kNoBlock = 0xffffffffu;
inline constexpr int kMaxBlockCoord = (1 << 20) - 16; // coordinates of a key lie within plus and minus this

inline BlockKey block_key(const BlockCoord& b)
{
    const auto biased = [](int c) { return static_cast<std::uint32_t>(c + (1 << 20)); };
    return morton_code(biased(b.x()), biased(b.y()), biased(b.z()));
}
BlockCoord block_coord(BlockKey key);

// Voxel x + 8 (y + 8 z). Means over observations, kept in few bits; integrate() sums in floats.
struct VoxelBlock {
    std::array<std::int16_t, kBlockVoxels> distance;              // 32767 = the truncation distance
    std::array<std::array<std::uint16_t, kBlockVoxels>, 3> color; // 256 times sRGB
    std::array<float, kBlockVoxels> weight;                       // 0 = never seen
    std::array<float, kBlockVoxels> color_weight;                 // 0 = no colour
};
inline constexpr float kDistanceScale = 32767.0f;
inline constexpr float kColorScale = 256.0f;

class VoxelGrid {
public:
    explicit VoxelGrid(double voxel_size) : voxel_size_(voxel_size), slots_(1024, Slot{}) {}

    double voxel_size() const { return voxel_size_; }              // [m]
    double block_size() const { return kBlockSide * voxel_size_; } // [m]
    // World coordinates of a voxel: (8 block + voxel + offset) * voxel_size [m].
    Eigen::Vector3d position(const BlockCoord& block, const Eigen::Vector3i& voxel) const
    {
        return (kBlockSide * block + voxel).cast<double>() * voxel_size_ +
               Eigen::Vector3d::Constant(kLatticeOffset * voxel_size_);
    }
    std::size_t size() const { return coords_.size(); }
    const BlockCoord& coord(BlockId id) const { return coords_[id]; }
    VoxelBlock& block(BlockId id) { return chunks_[id / kChunk][id % kChunk]; }
    const VoxelBlock& block(BlockId id) const { return chunks_[id / kChunk][id % kChunk]; }
    BlockId find(BlockKey key) const; // kNoBlock if there is none

    // Adds empty blocks; the keys are new and different.
    void create(std::span<const BlockKey> keys);

private:
    static constexpr std::size_t kChunk = 512; // blocks never move: 4 MB at a time
    struct Slot {
        BlockKey key = 0;
        BlockId id = kNoBlock;
    };
    std::size_t slot_of(BlockKey key) const; // where the key is or would be
    void grow_table();

    double voxel_size_;
    std::vector<BlockCoord> coords_;
    std::vector<std::unique_ptr<VoxelBlock[]>> chunks_;
    std::vector<Slot> slots_; // open addressing with linear probing; a power of two
};

} // namespace quoin
