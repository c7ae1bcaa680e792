// A stage that scales a mesh: the smallest program that honours the contract.
#include "base/error.h"
#include "base/progress.h"
#include "schema/schema.h"
#include "stage/stage.h"

#include <array>
#include <chrono>
#include <thread>

namespace quoin {

enum class Failure { None, Impossible, Memory, Bug };
constexpr auto choice_names(Failure) { return std::array{"none", "impossible", "memory", "bug"}; }

struct ToyParams {
    double factor = 2.0;
    int sleep = 0;
    Failure failure = Failure::None;

    static constexpr auto list()
    {
        using P = ToyParams;
        return std::tuple{
            Param{"factor", &P::factor, "", "what every coordinate is multiplied by", 0.0, 10.0},
            Param{"sleep", &P::sleep, "s", "how long to wait", 0.0, 60.0, ParamFlags{.affects_result = false}},
            Param{"failure", &P::failure, "", "how to fail"},
        };
    }
};

TriangleMesh scaled(TriangleMesh mesh, const ToyParams& params)
{
    Progress progress("scaling", mesh.position.size());
    for (auto& position : mesh.position)
        position *= static_cast<float>(params.factor);
    progress.step(mesh.position.size());
    std::this_thread::sleep_for(std::chrono::seconds(params.sleep));
    if (params.failure == Failure::Impossible) throw ImpossibleError("the mesh has no plane");
    if (params.failure == Failure::Memory) throw std::bad_alloc();
    if (params.failure == Failure::Bug) throw std::logic_error("oops");
    return mesh;
}

} // namespace quoin

int main(int argc, char** argv)
{
    using namespace quoin;
    const Stage stage{
        .name = "toy",
        .summary = "scales a mesh",
        .impl_version = 3,
        .inputs = {{"mesh", "what to scale"}},
        .outputs = {{"mesh", "the scaled mesh"}},
    };
    return run_stage<ToyParams>(stage, argc, argv, [](const StageRun& run, const ToyParams& params) {
        run.write("mesh", scaled(read_mesh(run.in("mesh")), params));
    });
}
