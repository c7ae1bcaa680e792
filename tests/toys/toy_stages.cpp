// Four small stages that honour the whole contract, in one executable: the name under which it is called says which.
//
//     read: folder -> mesh        one triangle for every line of points.txt; fails when the folder has a file "broken"
//     scale: mesh -> mesh         join: mesh, other -> mesh         weigh: mesh -> metrics
#include "base/atomic_file.h"
#include "base/error.h"
#include "base/parallel.h"
#include "schema/schema.h"
#include "stage/stage.h"

#include <chrono>
#include <sstream>
#include <string_view>
#include <thread>

namespace quoin {

struct ReadParams {
    double pause = 0.0;

    static constexpr auto list()
    {
        using P = ReadParams;
        return std::tuple{Param{"pause", &P::pause, "s", "how long to wait before the result", 0.0, 600.0,
                                ParamFlags{.affects_result = false}}};
    }
};

struct ScaleParams {
    double factor = 2.0;
    double pause = 0.0;
    std::string note;

    static constexpr auto list()
    {
        using P = ScaleParams;
        return std::tuple{Param{"factor", &P::factor, "", "what every coordinate is multiplied by", 0.0, 100.0},
                          Param{"pause", &P::pause, "s", "how long to wait before the result", 0.0, 600.0,
                                ParamFlags{.affects_result = false}},
                          Param{"note", &P::note, "", "a text that changes nothing but the key"}};
    }
};

struct NoParams {
    static constexpr auto list() { return std::tuple{}; }
};

void wait_for(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

TriangleMesh read_points(const std::filesystem::path& folder, const ReadParams& params)
{
    wait_for(params.pause);
    if (std::filesystem::exists(folder / "broken"))
        throw InputError((folder / "broken").string() + ": the scan is broken");
    std::istringstream lines(read_text(folder / "points.txt"));
    TriangleMesh mesh;
    for (float x = 0, y = 0, z = 0; lines >> x >> y >> z;) {
        const auto first = static_cast<VertexId>(mesh.position.size());
        mesh.position.insert(mesh.position.end(), {{x, y, z}, {x + 1, y, z}, {x, y + 1, z}});
        mesh.face.push_back({first, first + 1, first + 2});
    }
    if (mesh.face.empty()) throw ImpossibleError("points.txt has no points");
    return mesh;
}

TriangleMesh scaled(TriangleMesh mesh, const ScaleParams& params)
{
    wait_for(params.pause);
    parallel_for(mesh.position.size(), [&](std::size_t i) { mesh.position[i] *= static_cast<float>(params.factor); });
    return mesh;
}

TriangleMesh joined(TriangleMesh mesh, const TriangleMesh& other)
{
    const auto offset = static_cast<VertexId>(mesh.position.size());
    mesh.position.insert(mesh.position.end(), other.position.begin(), other.position.end());
    for (const auto& face : other.face)
        mesh.face.push_back({face[0] + offset, face[1] + offset, face[2] + offset});
    return mesh;
}

Metrics weighed(const TriangleMesh& mesh)
{
    double sum = 0.0;
    for (const auto& p : mesh.position)
        sum += p.x() + p.y() + p.z();
    return {{"sum", "m", sum, Better::Neither}};
}

int run_named_stage(std::string_view name, int argc, char** argv)
{
    if (name == "read")
        return run_stage<ReadParams>({.name = "read",
                                      .summary = "reads points",
                                      .inputs = {{"folder", "a scan"}},
                                      .outputs = {{"mesh", "triangles"}}},
                                     argc, argv, [](const StageRun& run, const ReadParams& p) {
                                         run.write("mesh", read_points(run.in("folder"), p));
                                     });
    if (name == "scale")
        return run_stage<ScaleParams>(
            {.name = "scale", .summary = "scales a mesh", .inputs = {{"mesh", "any"}}, .outputs = {{"mesh", "scaled"}}},
            argc, argv,
            [](const StageRun& run, const ScaleParams& p) { run.write("mesh", scaled(read_mesh(run.in("mesh")), p)); });
    if (name == "join")
        return run_stage<NoParams>({.name = "join",
                                    .summary = "puts two meshes into one",
                                    .inputs = {{"mesh", "first"}, {"other", "second", false, "mesh"}},
                                    .outputs = {{"mesh", "both"}}},
                                   argc, argv, [](const StageRun& run, const NoParams&) {
                                       run.write("mesh", joined(read_mesh(run.in("mesh")), read_mesh(run.in("other"))));
                                   });
    return run_stage<NoParams>({.name = "weigh",
                                .summary = "sums coordinates",
                                .inputs = {{"mesh", "any"}},
                                .outputs = {{"metrics", "the sum"}}},
                               argc, argv, [](const StageRun& run, const NoParams&) {
                                   run.write("metrics", weighed(read_mesh(run.in("mesh"))));
                               });
}

} // namespace quoin

int main(int argc, char** argv)
{
    return quoin::run_named_stage(std::filesystem::path(argv[0]).filename().string(), argc, argv);
}
