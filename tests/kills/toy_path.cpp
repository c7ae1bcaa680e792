// Four small stages in one program, which is the one that it is called as: a data path that takes milliseconds.
#include "artifact/digest.h"
#include "base/atomic_file.h"
#include "schema/schema.h"
#include "stage/stage.h"

#include <filesystem>

namespace quoin {
namespace {

struct SourceParams {
    int seed = 1;

    static constexpr auto list() { return std::tuple{Param{"seed", &SourceParams::seed, "", "of the mesh", 0.0, 1e9}}; }
};

struct ScaleParams {
    double factor = 2.0;

    static constexpr auto list()
    {
        return std::tuple{Param{"factor", &ScaleParams::factor, "", "of every coordinate", 0.0, 100.0}};
    }
};

struct NoParams {
    static constexpr auto list() { return std::tuple{}; }
};

TriangleMesh make_mesh(int seed)
{
    constexpr int kVertices = 3000;
    TriangleMesh mesh;
    for (int i = 0; i < kVertices; ++i)
        mesh.position.emplace_back(static_cast<float>(i), static_cast<float>(seed), static_cast<float>(i % 7));
    for (std::uint32_t i = 0; i + 2 < kVertices; ++i)
        mesh.face.push_back({i, i + 1, i + 2});
    return mesh;
}

TriangleMesh scaled(TriangleMesh mesh, double factor)
{
    for (auto& position : mesh.position)
        position *= static_cast<float>(factor);
    return mesh;
}

TriangleMesh joined(TriangleMesh mesh, const TriangleMesh& other)
{
    mesh.position.insert(mesh.position.end(), other.position.begin(), other.position.end());
    return mesh;
}

int source(int argc, char** argv)
{
    const Stage stage{
        .name = "toy-source", .summary = "makes a mesh", .inputs = {{"folder", "scan"}}, .outputs = {{"mesh", "made"}}};
    return run_stage<SourceParams>(stage, argc, argv, [](const StageRun& run, const SourceParams& params) {
        run.write("mesh", make_mesh(params.seed));
    });
}

int scale(int argc, char** argv)
{
    const Stage stage{
        .name = "toy-scale", .summary = "scales", .inputs = {{"mesh", "to scale"}}, .outputs = {{"mesh", "scaled"}}};
    return run_stage<ScaleParams>(stage, argc, argv, [](const StageRun& run, const ScaleParams& params) {
        run.write("mesh", scaled(read_mesh(run.in("mesh")), params.factor));
    });
}

int join(int argc, char** argv)
{
    const Stage stage{.name = "toy-join",
                      .summary = "joins",
                      .inputs = {{"mesh", "one"}, {"other", "another", false, "mesh"}},
                      .outputs = {{"mesh", "both"}}};
    return run_stage<NoParams>(stage, argc, argv, [](const StageRun& run, const NoParams&) {
        run.write("mesh", joined(read_mesh(run.in("mesh")), read_mesh(run.in("other"))));
    });
}

int folder(int argc, char** argv)
{
    const Stage stage{.name = "toy-folder",
                      .summary = "writes files",
                      .inputs = {{"mesh", "to write"}},
                      .outputs = {{"model", "files"}}};
    return run_stage<NoParams>(stage, argc, argv, [](const StageRun& run, const NoParams&) {
        const TriangleMesh mesh = read_mesh(run.in("mesh"));
        run.write_folder("model", [&](const std::filesystem::path& place) {
            write_atomically(place / "count.txt", std::to_string(mesh.position.size()));
            write_atomically(place / "sum.txt", std::to_string(mesh.position.back().sum()));
        });
    });
}

} // namespace
} // namespace quoin

int main(int argc, char** argv)
{
    const std::string name = std::filesystem::path(argv[0]).filename();
    if (name == "toy-source") return quoin::source(argc, argv);
    if (name == "toy-scale") return quoin::scale(argc, argv);
    return name == "toy-join" ? quoin::join(argc, argv) : quoin::folder(argc, argv);
}
