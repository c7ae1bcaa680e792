// The stages from a dense mesh to a light one, on meshes that are no good: each ends with a sound mesh, or with one
// message that says why not and leaves nothing behind.
#include "artifact/artifact.h"
#include "build_paths.h"
#include "mesh/hygiene.h"
#include "mesh/invariants.h"
#include "schema/schema.h"
#include "simplify/simplify.h"
#include "support/command.h"
#include "support/grids.h"
#include "support/plane_meshes.h"
#include "support/temporary_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <limits>

namespace quoin {
namespace {

namespace fs = std::filesystem;
using test::append;
using test::CommandResult;
using test::grid;
using test::TemporaryFolder;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
const double kMaxOpenError = SimplifyParams{}.max_open_error; // [m]

class BadMeshes : public testing::Test {
protected:
    CommandResult stage(const std::string& arguments) const
    {
        return test::run_command("cd '" + folder_.path().string() +
                                 "' && unset QUOIN_STORE && " QUOIN_BINARY_DIR "/bin/" + arguments +
                                 " --cache off --progress none --threads 2");
    }
    CommandResult partition(const TriangleMesh& mesh, const std::string& options = "") const
    {
        write_artifact(folder_ / "mesh", to_artifact(mesh));
        return stage("partition --in mesh=mesh --out plane_mesh=partitioned " + options);
    }
    CommandResult merge() const { return stage("merge --in plane_mesh=partitioned --out plane_mesh=merged"); }
    CommandResult simplify(const std::string& options = "") const
    {
        return stage("simplify --in plane_mesh=merged --out plane_mesh=simplified " + options);
    }

    // Both methods of simplify must end with a sound mesh; returns those of remesh and qem.
    std::array<PlaneMesh, 2> light_meshes(const TriangleMesh& mesh) const
    {
        std::array<PlaneMesh, 2> result;
        const CommandResult partitioned = partition(mesh), merged = merge();
        EXPECT_EQ(partitioned.exit_code, 0) << partitioned.output;
        EXPECT_EQ(merged.exit_code, 0) << merged.output;
        for (const char* name : {"partitioned", "merged"})
            EXPECT_EQ(broken_promise_of_planes(read_plane_mesh(folder_ / name)), "") << name;
        for (const std::size_t i : {0u, 1u}) {
            const std::string method = i == 0 ? "remesh" : "qem";
            const CommandResult simplified = simplify("--set method=" + method);
            EXPECT_EQ(simplified.exit_code, 0) << simplified.output;
            if (simplified.exit_code != 0) continue;
            result[i] = read_plane_mesh(folder_ / "simplified");
            expect_sound(result[i], method);
        }
        return result;
    }

    static void expect_sound(const PlaneMesh& mesh, const std::string& method)
    {
        EXPECT_EQ(broken_promise_of_light_mesh(mesh), "") << method;
        const Hygiene found = inspect(mesh);
        EXPECT_EQ(found.folded_pairs, 0u) << method;
        EXPECT_EQ(found.zero_area_faces, 0u) << method;
        EXPECT_TRUE(std::ranges::all_of(mesh.mesh.position, [](const auto& p) { return p.allFinite(); })) << method;
    }

    // Is there nothing but what the stages were given?
    bool nothing_was_written() const
    {
        const fs::directory_iterator all(folder_.path());
        return std::all_of(begin(all), end(all), [](const auto& entry) {
            const std::string name = entry.path().filename();
            return name == "mesh" || name == "merged";
        });
    }

    TemporaryFolder folder_;
};

TriangleMesh floor(int cells) { return grid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, cells, cells); }

double area(const TriangleMesh& mesh)
{
    double sum = 0.0;
    for (FaceId f = 0; f < mesh.face.size(); ++f)
        sum += face_area(mesh, f);
    return sum;
}

TEST_F(BadMeshes, WithPositionsThatAreNotFiniteAreRefusedByName)
{
    ASSERT_EQ(partition(floor(4)).exit_code, 0);
    PlaneMesh planes = read_plane_mesh(folder_ / "partitioned");
    fs::remove(folder_ / "partitioned");
    for (const float bad : {kNaN, kInfinity, -kInfinity}) {
        planes.mesh.position[12].y() = bad;
        write_artifact(folder_ / "merged", to_artifact(planes));
        const std::string in_vain = " --in plane_mesh=merged --out plane_mesh=never";
        for (const CommandResult& result :
             {partition(planes.mesh), stage("merge" + in_vain), stage("simplify" + in_vain)}) {
            EXPECT_EQ(result.exit_code, 3) << result.output;
            EXPECT_THAT(result.output, AllOf(HasSubstr(fmt::format("vertex 12 at (0.5, {}, 0) is not finite", bad)),
                                             HasSubstr("; make the file again")));
            EXPECT_TRUE(nothing_was_written());
        }
    }
}

TEST_F(BadMeshes, WhoseSheetsShareAnEdgeComeApartThere)
{
    TriangleMesh mesh = floor(20);
    append(mesh, grid({0, 0.5, 0}, {1, 0, 0}, {0, 0, 1}, 20, 20));  // up from the middle
    append(mesh, grid({0, 0.5, 0}, {0, 0, -1}, {1, 0, 0}, 20, 20)); // and down
    mesh = test::welded(mesh);
    ASSERT_EQ(inspect(mesh).non_manifold_edges, 20u);
    for (const PlaneMesh& light : light_meshes(mesh)) {
        EXPECT_NEAR(area(light.mesh), 3.0, 0.01);
        EXPECT_LE(light.mesh.face.size(), 12u);
    }
}

TEST_F(BadMeshes, OfBoxesThatShareAnEdgeOrAPointComeApartThere)
{
    for (const auto& other : {Eigen::Vector3f(1, 1, 0), Eigen::Vector3f(1, 1, 1)}) {
        TriangleMesh mesh = testing_support::box({1, 1, 1}, 10).mesh, second = mesh;
        for (auto& p : second.position)
            p += other;
        append(mesh, second);
        mesh = test::welded(mesh);
        const Hygiene found = inspect(mesh);
        ASSERT_EQ(found.non_manifold_edges + found.bow_tie_vertices, other.z() == 0.0f ? 10u : 1u);
        for (const PlaneMesh& light : light_meshes(mesh)) {
            EXPECT_EQ(light.mesh.face.size(), 24u);
            EXPECT_EQ(light.plane.size(), 12u);
            EXPECT_EQ(inspect(light).euler_characteristic, 4);
            EXPECT_EQ(inspect(light).border_edges, 0u);
        }
    }
}

TEST_F(BadMeshes, ThatTouchInAPointComeApartThere)
{
    TriangleMesh mesh = floor(20);
    append(mesh, grid({1, 1, 0}, {1, 0, 0}, {0, 1, 0}, 20, 20));
    mesh = test::welded(mesh);
    ASSERT_EQ(inspect(mesh).bow_tie_vertices, 1u);
    for (const PlaneMesh& light : light_meshes(mesh)) {
        EXPECT_EQ(light.mesh.face.size(), 4u);
        EXPECT_EQ(light.mesh.position.size(), 8u);
    }
}

TEST_F(BadMeshes, WithAPatchThatIsTurnedOverKeepItAsAPlaneOfItsOwn)
{
    TriangleMesh mesh = floor(20);
    for (FaceId f = 0; f < mesh.face.size(); ++f)
        if ((corner(mesh, f, 0) - Eigen::Vector3d(0.5, 0.5, 0.0)).cwiseAbs().maxCoeff() < 0.2)
            std::swap(mesh.face[f][1], mesh.face[f][2]);
    for (const PlaneMesh& light : light_meshes(mesh)) {
        ASSERT_EQ(light.plane.size(), 2u);
        EXPECT_LT(light.plane[0].normal.dot(light.plane[1].normal), -0.99);
        EXPECT_NEAR(area(light.mesh), 1.0, 0.01);
    }
}

TEST_F(BadMeshes, OfAHundredThousandPiecesKeepThemAll)
{
    constexpr int kSide = 316;
    TriangleMesh mesh;
    for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide + 1; ++i)
            append(mesh, grid({0.2 * i, 0.2 * j, 0.01 * ((7 * i + 3 * j) % 11)}, {0.1, 0, 0}, {0, 0.1, 0}, 1, 1));
    ASSERT_EQ(inspect(mesh).components, 100172u);
    for (const PlaneMesh& light : light_meshes(mesh)) {
        EXPECT_EQ(inspect(light).components, 100172u);
        EXPECT_EQ(light.mesh.face.size(), mesh.face.size());
    }
}

TEST_F(BadMeshes, OfOneGiantPlaneAreTwoFaces)
{
    const TriangleMesh mesh = grid({-20, -20, 0}, {40, 0, 0}, {0, 40, 0}, 500, 500, 0.002);
    for (const PlaneMesh& light : light_meshes(mesh)) {
        EXPECT_EQ(light.plane.size(), 1u);
        EXPECT_LE(light.mesh.face.size(), 4u);
        EXPECT_NEAR(area(light.mesh), 1600.0, 160.0 * kMaxOpenError);
    }
}

TEST_F(BadMeshes, OfASphereStayClosed)
{
    const TriangleMesh mesh = test::sphere(6, 0.5);
    for (const PlaneMesh& light : light_meshes(mesh)) {
        EXPECT_EQ(inspect(light).euler_characteristic, 2);
        EXPECT_EQ(inspect(light).border_edges, 0u);
        EXPECT_NEAR(area(light.mesh), 4.0 * M_PI * 0.25, 0.2);
    }
}

TEST_F(BadMeshes, OfNeedlesAreAFewSoundFaces)
{
    // A square of rows across it, in turns 0.4 mm and a micrometre wide.
    TriangleMesh mesh = grid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 1, 5000);
    for (std::size_t v = 2; v + 2 < mesh.position.size(); v += 4)
        for (const std::size_t end : {v, v + 1})
            mesh.position[end].y() = mesh.position[end - 2].y() + 1e-6f;
    const auto [remeshed, contracted] = light_meshes(mesh);
    EXPECT_EQ(remeshed.mesh.face.size(), 2u);
    EXPECT_NEAR(area(remeshed.mesh), 1.0, 1e-3);
    EXPECT_LT(contracted.mesh.face.size(), mesh.face.size() / 2); // no contraction makes a needle worse
    EXPECT_NEAR(area(contracted.mesh), 1.0, 4.0 * kMaxOpenError);
}

TEST_F(BadMeshes, WithThousandsOfFacesWhoseVerticesCoincideLoseThem)
{
    TriangleMesh mesh = floor(40);
    for (VertexId v = 0; v < 1600; ++v) {
        const auto first = static_cast<VertexId>(mesh.position.size());
        mesh.position.insert(mesh.position.end(), 3, Eigen::Vector3f(mesh.position[v]));
        mesh.face.insert(mesh.face.end(), {{first, first + 1, first + 2}, {v, v, v}, {v, v, v + 1}});
        mesh.face.push_back({v, first, first + 1}); // on a vertex of the floor
    }
    for (const PlaneMesh& light : light_meshes(mesh)) {
        EXPECT_EQ(light.plane.size(), 1u);
        EXPECT_EQ(light.mesh.face.size(), 2u);
    }
}

TEST_F(BadMeshes, OfNothingButFacesWithoutAreaHaveNoPlane)
{
    TriangleMesh mesh;
    mesh.position.assign(6000, Eigen::Vector3f(1.0f, 2.0f, 3.0f));
    for (VertexId v = 0; v < 6000; v += 3)
        mesh.face.push_back({v, v + 1, v + 2});
    const CommandResult result = partition(mesh);
    EXPECT_EQ(result.exit_code, 5) << result.output;
    EXPECT_THAT(result.output, HasSubstr("none of its 2000 faces has an area"));
    EXPECT_TRUE(nothing_was_written());
}

TEST_F(BadMeshes, OfTenFacesStayAsTheyAre)
{
    TriangleMesh mesh = grid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 1, 1);
    append(mesh, grid({0, 0, 0}, {0, 1, 0}, {0, 0, 1}, 2, 2)); // a wall
    for (const PlaneMesh& light : light_meshes(mesh)) {
        EXPECT_EQ(light.plane.size(), 2u);
        EXPECT_EQ(light.mesh.face.size(), 4u);
        EXPECT_NEAR(area(light.mesh), 2.0, 0.01);
    }
}

TEST_F(BadMeshes, InMillimetresAreWarnedOfWithTheSizeThatResults)
{
    const TriangleMesh mesh = grid({0, 0, 0}, {5200, 0, 0}, {0, 4100, 0}, 20, 20);
    const CommandResult result = partition(mesh);
    EXPECT_EQ(result.exit_code, 0) << result.output;
    EXPECT_THAT(result.output, AllOf(HasSubstr("5200.0 x 4100.0 x 0.0 m"), HasSubstr("millimetres"),
                                     HasSubstr("to 5.2 x 4.1 x 0.0 m")));
    EXPECT_THAT(partition(floor(20)).output, Not(HasSubstr("millimetres")));
}

TEST_F(BadMeshes, OfFewerFacesThanAskedForStayAsTheyAre)
{
    const TriangleMesh mesh = floor(20);
    ASSERT_EQ(partition(mesh, "--set clusters=100000").exit_code, 0);
    EXPECT_EQ(read_plane_mesh(folder_ / "partitioned").plane.size(), mesh.face.size());
    ASSERT_EQ(partition(mesh).exit_code, 0);
    ASSERT_EQ(merge().exit_code, 0);
    for (const std::string method : {"remesh", "qem"}) {
        const CommandResult result = simplify("--set face_budget=100000 --set method=" + method);
        EXPECT_EQ(result.exit_code, 0) << result.output;
        EXPECT_EQ(read_plane_mesh(folder_ / "simplified").mesh.face.size(), 2u);
    }
}

TEST_F(BadMeshes, ThatDoNotFitIntoMemorySayWhatTheyWouldTake)
{
    const TriangleMesh mesh = floor(1000);
    const auto end_with_less_and_with_what_it_takes = [&](const auto& run) {
        const CommandResult result = run("--memory 100M");
        EXPECT_EQ(result.exit_code, 4) << result.output;
        EXPECT_THAT(result.output, HasSubstr("out of memory with --memory 100M; inputs of this size take about "));
        EXPECT_TRUE(nothing_was_written());
        const std::size_t begin = result.output.find("about ") + 6;
        const std::string enough = result.output.substr(begin, result.output.find(';', begin) - begin);
        EXPECT_EQ(run("--memory " + enough).exit_code, 0) << enough;
    };
    end_with_less_and_with_what_it_takes([&](const std::string& memory) { return partition(mesh, memory); });
    ASSERT_EQ(merge().exit_code, 0);
    fs::remove(folder_ / "partitioned");
    end_with_less_and_with_what_it_takes([&](const std::string& memory) { return simplify(memory); });
}

} // namespace
} // namespace quoin
