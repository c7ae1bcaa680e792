#include "foreign/sample_artifacts.h"

#include "schema/schema.h"

namespace quoin {
namespace {

constexpr int kCells = 8; // along each side of a square

// Floor and wall share the vertices of their common side, row kCells of the one and row 0 of the other.
TriangleMesh floor_and_wall()
{
    TriangleMesh mesh;
    for (int row = 0; row <= 2 * kCells; ++row)
        for (int i = 0; i <= kCells; ++i) {
            const float x = static_cast<float>(i) / kCells;
            const float along = static_cast<float>(row) / kCells;
            mesh.position.push_back(along <= 1 ? Eigen::Vector3f(x, along, 0) : Eigen::Vector3f(x, 1, along - 1));
        }
    const auto id = [](int row, int i) { return static_cast<VertexId>(row * (kCells + 1) + i); };
    for (int row = 0; row < 2 * kCells; ++row)
        for (int i = 0; i < kCells; ++i) {
            mesh.face.push_back({id(row, i), id(row, i + 1), id(row + 1, i + 1)});
            mesh.face.push_back({id(row, i), id(row + 1, i + 1), id(row + 1, i)});
        }
    return mesh;
}

// Each square is cut into two clusters, left and right.
PlaneMesh clustered(const TriangleMesh& mesh)
{
    PlaneMesh clusters{mesh, {}, {}, std::vector<Moments>(4), {}};
    for (std::size_t f = 0; f < mesh.face.size(); ++f) {
        const std::size_t cell = f / 2;
        const bool is_wall = cell / kCells >= kCells;
        const bool is_right = cell % kCells >= kCells / 2;
        const auto plane = static_cast<PlaneId>(2 * is_wall + is_right);
        clusters.face_plane.push_back(plane);
        const auto corner = [&](int k) { return Eigen::Vector3d(mesh.position[mesh.face[f][k]].cast<double>()); };
        clusters.moments[plane] += triangle_moments(corner(0), corner(1), corner(2));
    }
    clusters.plane = {{{0, 0, 1}, 0.0}, {{0, 0, 1}, 0.0}, {{0, -1, 0}, 1.0}, {{0, -1, 0}, 1.0}};
    clusters.vertex_class = classify_vertices(mesh, clusters.face_plane);
    return clusters;
}

} // namespace

bool write_sample(const std::filesystem::path& path, const std::string& schema)
{
    if (schema == "mesh")
        write_artifact(path, to_artifact(floor_and_wall()));
    else if (schema == "plane_mesh")
        write_artifact(path, to_artifact(clustered(floor_and_wall())));
    return schema == "mesh" || schema == "plane_mesh";
}

} // namespace quoin
