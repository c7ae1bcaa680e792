// meshoptimizer's simplify, to a number of faces: what Quoin's stages are measured against.
//
//     decimate MESH.safetensors FACES OUT.safetensors      prints the seconds of processor time that it took
#include "artifact/artifact.h"
#include "base/error.h"
#include "mesh/cleanup.h"
#include "schema/schema.h"

#include <cstdio>
#include <ctime>
#include <limits>
#include <meshoptimizer.h>
#include <string>

namespace {

using namespace quoin;

TriangleMesh decimated(TriangleMesh mesh, std::size_t faces, double& seconds)
{
    constexpr float kAnyError = std::numeric_limits<float>::max();
    std::vector<unsigned int> index(3 * mesh.face.size());
    const std::clock_t start = std::clock();
    const std::size_t count =
        meshopt_simplify(index.data(), mesh.face.data()->data(), index.size(), mesh.position.data()->data(),
                         mesh.position.size(), sizeof(mesh.position[0]), 3 * faces, kAnyError, 0, nullptr);
    seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    mesh.face.clear();
    for (std::size_t i = 0; i < count; i += 3)
        mesh.face.push_back({index[i], index[i + 1], index[i + 2]});
    remove_isolated_vertices(mesh);
    return mesh;
}

// evaluate measures plane meshes: all faces in one.
PlaneMesh as_plane_mesh(TriangleMesh mesh)
{
    PlaneMesh result;
    result.face_plane.assign(mesh.face.size(), 0);
    result.plane.resize(1);
    result.moments.resize(1);
    result.vertex_class = classify_vertices(mesh, result.face_plane);
    result.mesh = std::move(mesh);
    return result;
}

} // namespace

int main(int argc, char** argv)
{
    if (argc != 4) {
        std::fputs("usage: decimate MESH FACES OUT\n", stderr);
        return 2;
    }
    try {
        double seconds = 0.0;
        const TriangleMesh mesh = decimated(read_mesh(argv[1]), std::stoul(argv[2]), seconds);
        write_artifact(argv[3], to_artifact(as_plane_mesh(mesh)));
        std::printf("%.3f\n", seconds);
    } catch (const quoin::Error& error) {
        std::fprintf(stderr, "decimate: %s\n", error.what());
        return static_cast<int>(error.code());
    }
    return 0;
}
