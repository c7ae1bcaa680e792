// Prints how long one photometric pass at full resolution takes an observation, and what the joint solver and the
// alternating one make of the same problem.
//
//     build/release/bin/bench_align [VIEWS]        default: 16 frames of a textured wall
#include "alignment/color_equations.h"
#include "alignment/problem.h"
#include "alignment/solver.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fmt/format.h>
#include <random>

namespace quoin {
namespace {

// Of the processor, which on a loaded machine is the steadier figure; one thread runs.
class CpuTimer {
public:
    double seconds() const { return static_cast<double>(std::clock() - start_) / CLOCKS_PER_SEC; }

private:
    std::clock_t start_ = std::clock();
};

constexpr double kTargetNanoseconds = 8.0;
constexpr double kTargetShare = 0.2; // of the alternating solver's time
constexpr int kPasses = 9;
constexpr double kWallSize = 3.0; // [m]
constexpr double kDistance = 2.0; // of the cameras [m]

// A wall before z = kDistance with a smooth pattern, seen by frames whose poses and plane are disturbed.
struct Wall {
    PlaneMesh mesh;
    OptimizeTextureParams params;
    Camera camera{.width = 640, .height = 480, .fx = 525.0, .fy = 525.0, .cx = 319.5, .cy = 239.5};
    std::vector<Rigid> true_pose;
    AlignmentState state;
};

double pattern(double x, double y)
{
    return 0.5 + 0.15 * std::sin(23.0 * x + 5.0 * y) + 0.15 * std::cos(19.0 * y - 4.0 * x) +
           0.1 * std::sin(61.0 * x) * std::cos(53.0 * y);
}

PlaneMesh wall_mesh()
{
    PlaneMesh mesh;
    const auto half = static_cast<float>(kWallSize / 2.0), z = static_cast<float>(kDistance);
    mesh.mesh.position = {{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}};
    mesh.mesh.face = {{0, 2, 1}, {0, 3, 2}};
    mesh.face_plane = {0, 0};
    mesh.plane = {{-Vector3::UnitZ(), kDistance}};
    const auto at = [&](std::size_t i) { return Vector3(mesh.mesh.position[i].cast<double>()); };
    mesh.moments = {triangle_moments(at(0), at(2), at(1)) + triangle_moments(at(0), at(3), at(2))};
    return mesh;
}

Wall make_wall(std::size_t frames)
{
    Wall wall;
    wall.mesh = wall_mesh();
    std::mt19937 generator(1);
    const auto random = [&](double size) {
        const auto one = [&] { return std::uniform_real_distribution<double>(-size, size)(generator); };
        const double x = one(), y = one();
        return Vector3(x, y, one());
    };
    for (std::size_t k = 0; k < frames; ++k) {
        const Vector3 turn = random(0.1);
        wall.true_pose.push_back(exp_twist(twist(turn, random(0.3))));
        const Vector3 error = random(0.004);
        wall.state.camera_from_world.push_back(moved(wall.true_pose.back(), twist(error, random(0.008))));
    }
    wall.state.plane = {centered(wall.mesh.plane[0], wall.mesh.moments[0].centroid())};
    wall.state.exposure.resize(frames);
    wall.state.color = {wall.camera, Rigid::Identity()};
    return wall;
}

GrayImage photograph(const Wall& wall, const Rigid& camera_from_world)
{
    GrayImage image(wall.camera.width, wall.camera.height);
    const Rigid world_from_camera = camera_from_world.inverse();
    const Vector3 from = world_from_camera.translation();
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const Vector3 ray = world_from_camera.linear() * wall.camera.ray({x, y});
            const Vector3 p = from + (kDistance - from.z()) / ray.z() * ray;
            image.at(x, y) = static_cast<float>(pattern(p.x(), p.y()));
        }
    return image;
}

AlignmentScene make_scene(const Wall& wall)
{
    AlignmentScene scene{wall.mesh, wall.params, wall.camera, {}};
    scene.images.resize(wall.true_pose.size());
    parallel_for(wall.true_pose.size(),
                 [&](std::size_t k) { scene.images[k].gray = {photograph(wall, wall.true_pose[k])}; });
    return scene;
}

// The median of passes that each do `work`.
template <class Work>
double pass_seconds(const Work& work)
{
    std::vector<double> seconds;
    for (int pass = 0; pass < kPasses; ++pass) {
        const CpuTimer timer;
        work();
        seconds.push_back(timer.seconds());
    }
    std::ranges::sort(seconds);
    return seconds[kPasses / 2];
}

// Of all observations at frozen colours: residuals alone, and with the normal equations of poses, planes and colour
// camera (gradient and diagonal blocks); and of the joint solver, whose equations have the colours eliminated.
void time_passes(const AlignmentProblem& problem, const AlignmentState& state)
{
    const auto count = static_cast<double>(problem.observations.size());
    const Fit start = fit(problem, state);
    const auto nanoseconds = [&](const auto& work) { return 1e9 * pass_seconds(work) / count; };
    const double equations = nanoseconds([&] { frozen_colors(problem, state, start.color); });
    const double residuals = nanoseconds([&] { energies(problem, state, start.color); });
    const double fits = nanoseconds([&] { fit(problem, state); });
    const double eliminated = nanoseconds([&] { color_equations(problem, start); });
    const ColorEquations joint = color_equations(problem, start);
    StepVector product = StepVector::Ones(joint.layout.size());
    const double products = nanoseconds([&] { joint.add_product(StepVector::Ones(joint.layout.size()), product); });
    fmt::print("photometric pass at full resolution {:5.1f} ns an observation and core, target {:.0f} ({:.1f} M); "
               "residuals alone {:.1f}\n",
               equations, kTargetNanoseconds, 1e-6 * count, residuals);
    fmt::print("joint solver: samples and colours {:.1f} ns, equations {:.1f}, a product {:.1f}\n", fits, eliminated,
               products);
}

struct Outcome {
    double energy, seconds;
};

template <class Solver>
Outcome solve(const Solver& solver, const AlignmentProblem& problem, const AlignmentState& start)
{
    const CpuTimer timer;
    const AlignmentState state = solver(problem, start);
    const double seconds = timer.seconds();
    return {fit(problem, state).energy.total(), seconds};
}

void align(std::size_t views)
{
    set_thread_count(1);
    const Wall wall = make_wall(views);
    const AlignmentScene scene = make_scene(wall);
    const ProblemSource source{scene, wall.state, wall.params.lambda_p, {}, {}, {}};
    const auto problem =
        make_problem(source, wall.state, 0, wall.params.texel_size * wall.params.texel_stride, TexelChoice::All);
    time_passes(problem, wall.state);
    const Outcome joint = solve(minimize_jointly, problem, wall.state);
    const auto alternate = [](const AlignmentProblem& wall_problem, const AlignmentState& start) {
        return minimize_alternating(wall_problem, start, [](const AlignmentState&) {});
    };
    const Outcome alternating = solve(alternate, problem, wall.state);
    fmt::print("joint: energy {:.4g} in {:.2f} s; alternating: energy {:.4g} in {:.2f} s; "
               "target: less in {:.2f} s\n",
               joint.energy, joint.seconds, alternating.energy, alternating.seconds,
               kTargetShare * alternating.seconds);
}

} // namespace
} // namespace quoin

int main(int argc, char** argv) { quoin::align(argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 16); }
