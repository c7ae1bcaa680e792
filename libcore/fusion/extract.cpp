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

enum class Sample : std::uint8_t { Unknown, Outside, Inside };

// The crossings on the edges that start in a block, as bits: the number of a vertex is that of the set bits before its
// own.
struct BlockSurface {
    std::array<BlockId, 8> neighbour{}; // at +1 along the axes whose bit is set; 0 is the block itself
    std::array<std::array<std::uint64_t, kBlockSide>, 3> mask{}; // [axis][z], bit x + 8 y
    std::array<std::array<std::uint16_t, kBlockSide>, 3> rank{}; // set bits before the word
    std::uint32_t vertices = 0, faces = 0;
    std::uint32_t first_vertex = 0, first_face = 0;
};

struct Samples {
    std::array<Sample, kSide * kSide * kSide> state{};
    Sample& at(const Voxel& v) { return state[static_cast<std::size_t>(v.x() + kSide * (v.y() + kSide * v.z()))]; }
    Sample at(const Voxel& v) const { return state[static_cast<std::size_t>(v.x() + kSide * (v.y() + kSide * v.z()))]; }
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

template <class Visit>
void for_voxels(int side, const Visit& visit)
{
    for (int z = 0; z < side; ++z)
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x)
                visit(Voxel(x, y, z));
}

void find_neighbours(const VoxelGrid& grid, BlockId id, BlockSurface& surface)
{
    for (int n = 0; n < 8; ++n)
        surface.neighbour[static_cast<std::size_t>(n)] =
            grid.find(block_key(grid.coord(id) + BlockCoord(n & 1, n >> 1 & 1, n >> 2)));
}

Samples sample(const VoxelGrid& grid, const BlockSurface& surface, float min_weight)
{
    Samples samples;
    for_voxels(kSide, [&](const Voxel& v) {
        const VoxelRef voxel = voxel_at(grid, surface, v);
        if (!voxel.block || voxel.weight() <= 0.0f || voxel.weight() < min_weight) return;
        samples.at(v) = voxel.distance() < 0.0f ? Sample::Inside : Sample::Outside;
    });
    return samples;
}

// The set of inside corners of a cell; 0 where a corner is unknown.
unsigned inside_corners(const Samples& samples, const Voxel& cell)
{
    unsigned inside = 0;
    for (int c = 0; c < 8; ++c) {
        const Sample s = samples.at(cell + Voxel(c & 1, c >> 1 & 1, c >> 2));
        if (s == Sample::Unknown) return 0;
        inside |= s == Sample::Inside ? 1u << c : 0u;
    }
    return inside;
}

bool crosses(const Samples& samples, const Voxel& v, int axis)
{
    const Sample a = samples.at(v), b = samples.at(v + Voxel::Unit(axis));
    return a != b && a != Sample::Unknown && b != Sample::Unknown;
}

void count_surface(const Samples& samples, BlockSurface& surface)
{
    for_voxels(kBlockSide, [&](const Voxel& v) {
        for (int axis = 0; axis < 3; ++axis)
            if (crosses(samples, v, axis))
                surface.mask[static_cast<std::size_t>(axis)][static_cast<std::size_t>(v.z())] |= std::uint64_t{1}
                                                                                                 << (v.x() + 8 * v.y());
        surface.faces += static_cast<std::uint32_t>(cell_triangles()[inside_corners(samples, v)].size());
    });
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

void write_faces(const std::vector<BlockSurface>& surfaces, const BlockSurface& surface, const Samples& samples,
                 TriangleMesh& mesh)
{
    FaceId n = surface.first_face;
    for_voxels(kBlockSide, [&](const Voxel& cell) {
        for (const CellTriangle& triangle : cell_triangles()[inside_corners(samples, cell)]) {
            Face& face = mesh.face[n++];
            for (std::size_t k = 0; k < 3; ++k) {
                const auto [corner, axis] = cell_edges()[triangle[k]];
                const Voxel v = cell + Voxel(corner & 1, corner >> 1 & 1, corner >> 2);
                const BlockSurface& owner = surfaces[surface.neighbour[wrap_bits(v)]];
                face[k] = vertex_on(owner, Voxel(v.x() & 7, v.y() & 7, v.z() & 7), axis);
            }
        }
    });
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
