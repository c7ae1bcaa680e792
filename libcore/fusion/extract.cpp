#include "fusion/extract.h"

#include "base/parallel.h"
#include "fusion/marching_cubes.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace quoin {
namespace {

constexpr std::size_t kGrain = 64;    // [blocks]
constexpr int kSide = kBlockSide + 1; // samples of a block and the first ones of its upper neighbours
using Voxel = Eigen::Vector3i;        // within a block; a component of 8 belongs to the next block

// The crossings on the edges that start in a block, as bits: the number of a vertex is that of the set bits before its
// own.
struct BlockSurface {
    std::array<BlockId, 8> neighbour{}; // at +1 along the axes whose bit is set; 0 is the block itself
    std::array<std::array<std::uint64_t, kBlockSide>, 3> mask{}; // [axis][z], bit x + 8 y
    std::array<std::array<std::uint16_t, kBlockSide>, 3> rank{}; // set bits before the word
    std::uint32_t vertices = 0, faces = 0;
    std::uint32_t first_vertex = 0, first_face = 0;
};

// Which samples of a block are known and which of those lie inside, a row along x in a word: bit x.
struct Samples {
    using Rows = std::array<std::array<std::uint32_t, kSide>, kSide>; // [z][y]
    Rows known{}, inside{};
};

// A voxel in the block that has it.
struct VoxelRef {
    const VoxelBlock* block;
    std::size_t index;
    float distance() const { return block->distance[index]; }
    float weight() const { return block->weight[index]; }
    float color_weight() const { return block->color_weight[index]; }
    Eigen::Vector3f color() const
    {
        return Eigen::Vector3f(block->color[0][index], block->color[1][index], block->color[2][index]) / kColorScale;
    }
};

std::size_t wrap_bits(const Voxel& v)
{
    return static_cast<std::size_t>((v.x() >> 3) | (v.y() >> 3) << 1 | (v.z() >> 3) << 2);
}

VoxelRef voxel_at(const VoxelGrid& grid, const BlockSurface& surface, const Voxel& v)
{
    const BlockId id = surface.neighbour[wrap_bits(v)];
    if (id == kNoBlock) return {nullptr, 0};
    return {&grid.block(id), static_cast<std::size_t>((v.x() & 7) + 8 * ((v.y() & 7) + 8 * (v.z() & 7)))};
}

void find_neighbours(const VoxelGrid& grid, BlockId id, BlockSurface& surface)
{
    for (int n = 0; n < 8; ++n)
        surface.neighbour[static_cast<std::size_t>(n)] =
            grid.find(block_key(grid.coord(id) + BlockCoord(n & 1, n >> 1 & 1, n >> 2)));
}

struct RowBits {
    std::uint32_t known = 0, inside = 0;
};

// Of `count` voxels from `index` on.
RowBits sample_row(const VoxelBlock& block, std::size_t index, std::uint32_t count, float min_weight)
{
    RowBits bits;
    for (std::uint32_t x = 0; x < count; ++x) {
        const float weight = block.weight[index + x];
        const bool weighs = (weight > 0.0f) & (weight >= min_weight), is_inside = block.distance[index + x] < 0;
        bits.known |= static_cast<std::uint32_t>(weighs) << x;
        bits.inside |= static_cast<std::uint32_t>(weighs & is_inside) << x;
    }
    return bits;
}

// A row of a block's own voxels and the first one of the block behind it.
RowBits sample_row_and_next(const VoxelGrid& grid, const BlockSurface& surface, const Voxel& first, float min_weight)
{
    const BlockId own = surface.neighbour[wrap_bits(first)], next = surface.neighbour[wrap_bits(first) | 1];
    const auto index = static_cast<std::size_t>(8 * ((first.y() & 7) + 8 * (first.z() & 7)));
    RowBits bits, last;
    if (own != kNoBlock) bits = sample_row(grid.block(own), index, kBlockSide, min_weight);
    if (next != kNoBlock) last = sample_row(grid.block(next), index, 1, min_weight);
    return {bits.known | last.known << kBlockSide, bits.inside | last.inside << kBlockSide};
}

Samples sample(const VoxelGrid& grid, const BlockSurface& surface, float min_weight)
{
    Samples samples;
    for (int z = 0; z < kSide; ++z) {
        for (int y = 0; y < kSide; ++y) {
            const RowBits bits = sample_row_and_next(grid, surface, Voxel(0, y, z), min_weight);
            samples.known[static_cast<std::size_t>(z)][static_cast<std::size_t>(y)] = bits.known;
            samples.inside[static_cast<std::size_t>(z)][static_cast<std::size_t>(y)] = bits.inside;
        }
    }
    return samples;
}

constexpr std::uint32_t kRow = (1u << kBlockSide) - 1; // the bits of a block's own voxels

// Edges whose samples are both known and on different sides: of bits (known, inside) and those of the next sample.
std::uint32_t crossings(std::uint32_t known, std::uint32_t inside, std::uint32_t next_known, std::uint32_t next_inside)
{
    return known & next_known & (inside ^ next_inside) & kRow;
}

// Calls visit(x, inside corners) for the cells of a row that the surface passes: all corners are known, some inside.
template <class Visit>
void for_surface_cells(const Samples& samples, std::size_t y, std::size_t z, const Visit& visit)
{
    const std::array<std::uint32_t, 4> inside{samples.inside[z][y], samples.inside[z][y + 1], samples.inside[z + 1][y],
                                              samples.inside[z + 1][y + 1]};
    const std::uint32_t known =
        samples.known[z][y] & samples.known[z][y + 1] & samples.known[z + 1][y] & samples.known[z + 1][y + 1];
    const std::uint32_t any = inside[0] | inside[1] | inside[2] | inside[3],
                        all = inside[0] & inside[1] & inside[2] & inside[3];
    for (std::uint32_t cells = known & known >> 1 & (any | any >> 1) & ~(all & all >> 1) & kRow; cells != 0;
         cells &= cells - 1) {
        const int x = std::countr_zero(cells);
        unsigned corners = 0;
        for (std::size_t row = 0; row < 4; ++row)
            corners |= (inside[row] >> x & 3u) << (2 * row);
        visit(x, corners);
    }
}

void count_surface(const Samples& samples, BlockSurface& surface)
{
    const auto &known = samples.known, &inside = samples.inside;
    for (std::size_t z = 0; z < kBlockSide; ++z) {
        for (std::size_t y = 0; y < kBlockSide; ++y) {
            const std::uint32_t k = known[z][y], i = inside[z][y];
            const std::array<std::uint32_t, 3> rows{crossings(k, i, k >> 1, i >> 1),
                                                    crossings(k, i, known[z][y + 1], inside[z][y + 1]),
                                                    crossings(k, i, known[z + 1][y], inside[z + 1][y])};
            for (std::size_t axis = 0; axis < 3; ++axis)
                surface.mask[axis][z] |= std::uint64_t{rows[axis]} << (8 * y);
            for_surface_cells(samples, y, z, [&](int, unsigned corners) {
                surface.faces += static_cast<std::uint32_t>(cell_triangles()[corners].size());
            });
        }
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (std::size_t z = 0; z < kBlockSide; ++z) {
            surface.rank[axis][z] = static_cast<std::uint16_t>(surface.vertices);
            surface.vertices += static_cast<std::uint32_t>(std::popcount(surface.mask[axis][z]));
        }
    }
}

// The vertex on the edge from a voxel of the block itself along an axis.
VertexId vertex_on(const BlockSurface& surface, const Voxel& v, int axis)
{
    const auto a = static_cast<std::size_t>(axis), z = static_cast<std::size_t>(v.z());
    const std::uint64_t before = (std::uint64_t{1} << (v.x() + 8 * v.y())) - 1;
    return surface.first_vertex + surface.rank[a][z] +
           static_cast<VertexId>(std::popcount(surface.mask[a][z] & before));
}

struct Vertex {
    Eigen::Vector3f position; // world [m]
    Rgb8 color{};
    bool has_color = false;
};

Vertex interpolate(const VoxelRef& a, const VoxelRef& b, const Eigen::Vector3d& p_a, const Eigen::Vector3d& p_b)
{
    constexpr float kMargin = 1.0f / 64; // keeps vertices of one lattice point apart, so that no face collapses
    const float t = std::clamp(a.distance() / (a.distance() - b.distance()), kMargin, 1.0f - kMargin);
    Vertex vertex;
    vertex.position = (p_a + static_cast<double>(t) * (p_b - p_a)).cast<float>();
    const float weight_a = a.color_weight() > 0.0f ? 1.0f - t : 0.0f, weight_b = b.color_weight() > 0.0f ? t : 0.0f;
    if (weight_a + weight_b <= 0.0f) return vertex;
    const Eigen::Vector3f color = (weight_a * a.color() + weight_b * b.color()) / (weight_a + weight_b);
    for (int c = 0; c < 3; ++c)
        vertex.color[static_cast<std::size_t>(c)] =
            static_cast<std::uint8_t>(std::clamp(color[c] + 0.5f, 0.0f, 255.0f));
    vertex.has_color = true;
    return vertex;
}

struct Output {
    TriangleMesh mesh;
    std::vector<std::uint8_t> has_color; // V
};

void write_vertices(const VoxelGrid& grid, BlockId id, const BlockSurface& surface, Output& out)
{
    const auto world = [&](const Voxel& v) { return grid.position(grid.coord(id), v); };
    VertexId n = surface.first_vertex;
    for (int axis = 0; axis < 3; ++axis) {
        for (int z = 0; z < kBlockSide; ++z) {
            for (std::uint64_t bits = surface.mask[static_cast<std::size_t>(axis)][static_cast<std::size_t>(z)]; bits;
                 bits &= bits - 1) {
                const int bit = std::countr_zero(bits);
                const Voxel a(bit & 7, bit >> 3, z), b = a + Voxel::Unit(axis);
                const Vertex vertex =
                    interpolate(voxel_at(grid, surface, a), voxel_at(grid, surface, b), world(a), world(b));
                out.mesh.position[n] = vertex.position;
                out.mesh.color[n] = vertex.color;
                out.has_color[n++] = vertex.has_color;
            }
        }
    }
}

// Appends the faces of a cell at `next`.
void write_cell(const std::vector<BlockSurface>& surfaces, const BlockSurface& surface, const Voxel& cell,
                unsigned corners, Face*& next)
{
    for (const CellTriangle& triangle : cell_triangles()[corners]) {
        Face& face = *next++;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [corner, axis] = cell_edges()[triangle[k]];
            const Voxel v = cell + Voxel(corner & 1, corner >> 1 & 1, corner >> 2);
            const BlockSurface& owner = surfaces[surface.neighbour[wrap_bits(v)]];
            face[k] = vertex_on(owner, Voxel(v.x() & 7, v.y() & 7, v.z() & 7), axis);
        }
    }
}

void write_faces(const std::vector<BlockSurface>& surfaces, const BlockSurface& surface, const Samples& samples,
                 TriangleMesh& mesh)
{
    Face* next = mesh.face.data() + surface.first_face;
    for (int z = 0; z < kBlockSide; ++z)
        for (int y = 0; y < kBlockSide; ++y)
            for_surface_cells(
                samples, static_cast<std::size_t>(y), static_cast<std::size_t>(z),
                [&](int x, unsigned corners) { write_cell(surfaces, surface, Voxel(x, y, z), corners, next); });
}

// Spreads colours along faces until every vertex that is connected to a coloured one has one; grey for the rest.
void fill_missing_colors(Output& out)
{
    constexpr Rgb8 kGray{128, 128, 128};
    auto& mesh = out.mesh;
    auto& has_color = out.has_color;
    std::vector<FaceId> open;
    for (FaceId f = 0; f < mesh.face.size(); ++f)
        if (std::any_of(mesh.face[f].begin(), mesh.face[f].end(), [&](VertexId v) { return !has_color[v]; }))
            open.push_back(f);
    struct Sum {
        std::array<std::uint32_t, 3> color{};
        std::uint32_t count = 0;
    };
    std::vector<Sum> sums(open.empty() ? 0 : mesh.position.size());
    std::vector<VertexId> reached;
    do {
        reached.clear();
        for (const FaceId f : open) {
            for (std::size_t k = 0; k < 6; ++k) { // every ordered pair of corners
                const VertexId from = mesh.face[f][k % 3], to = mesh.face[f][(k + 1 + k / 3) % 3];
                if (!has_color[from] || has_color[to]) continue;
                if (sums[to].count++ == 0) reached.push_back(to);
                for (std::size_t c = 0; c < 3; ++c)
                    sums[to].color[c] += mesh.color[from][c];
            }
        }
        for (const VertexId v : reached) {
            for (std::size_t c = 0; c < 3; ++c)
                mesh.color[v][c] = static_cast<std::uint8_t>(sums[v].color[c] / sums[v].count);
            has_color[v] = 1;
        }
    } while (!reached.empty());
    for (VertexId v = 0; v < has_color.size(); ++v)
        if (!has_color[v]) mesh.color[v] = kGray;
}

// Numbers the vertices and faces of all blocks and makes room for them.
Output allocate_output(std::vector<BlockSurface>& surfaces, const std::vector<BlockId>& order)
{
    std::uint32_t vertices = 0, faces = 0;
    for (const BlockId id : order) {
        surfaces[id].first_vertex = vertices;
        surfaces[id].first_face = faces;
        vertices += surfaces[id].vertices;
        faces += surfaces[id].faces;
    }
    Output out;
    out.mesh.position.resize(vertices);
    out.mesh.color.resize(vertices);
    out.mesh.face.resize(faces);
    out.has_color.resize(vertices);
    return out;
}

std::vector<BlockId> blocks_along_morton(const VoxelGrid& grid)
{
    std::vector<std::pair<BlockKey, BlockId>> keys(grid.size());
    for (BlockId id = 0; id < grid.size(); ++id)
        keys[id] = {block_key(grid.coord(id)), id};
    std::sort(keys.begin(), keys.end());
    std::vector<BlockId> order(grid.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        order[i] = keys[i].second;
    return order;
}

} // namespace

TriangleMesh extract_surface(const VoxelGrid& grid, double min_weight)
{
    const auto threshold = static_cast<float>(min_weight);
    const std::vector<BlockId> order = blocks_along_morton(grid);
    std::vector<BlockSurface> surfaces(grid.size());
    const auto count = [&](std::size_t i) {
        find_neighbours(grid, order[i], surfaces[order[i]]);
        count_surface(sample(grid, surfaces[order[i]], threshold), surfaces[order[i]]);
    };
    parallel_for(order.size(), count, kGrain);

    Output out = allocate_output(surfaces, order);
    const auto write = [&](std::size_t i) {
        const BlockSurface& surface = surfaces[order[i]];
        write_vertices(grid, order[i], surface, out);
        if (surface.faces > 0) write_faces(surfaces, surface, sample(grid, surface, threshold), out.mesh);
    };
    parallel_for(order.size(), write, kGrain);

    const bool colored = std::find(out.has_color.begin(), out.has_color.end(), 1) != out.has_color.end();
    if (colored)
        fill_missing_colors(out);
    else
        out.mesh.color.clear();
    return std::move(out.mesh);
}

} // namespace quoin
