#include "build_paths.h"
#include "compare/compare.h"

#include "compare/plane_match.h"
#include "image/image_io.h"
#include "schema/schema.h"
#include "support/command.h"
#include "support/expect_error.h"
#include "support/plane_meshes.h"
#include "support/temporary_folder.h"

#include <gmock/gmock.h>

namespace quoin {
namespace {

using test::TemporaryFolder;
using testing::AllOf;
using testing::HasSubstr;
using testing_support::box;

constexpr double kDegree = 0.017453292519943295;

// The same surfaces elsewhere.
PlaneMesh moved(PlaneMesh mesh, const Eigen::Isometry3d& motion)
{
    for (auto& p : mesh.mesh.position)
        p = (motion * p.cast<double>()).cast<float>();
    for (auto& plane : mesh.plane) {
        plane.normal = motion.linear() * plane.normal;
        plane.offset -= plane.normal.dot(motion.translation());
    }
    return mesh;
}

class CompareArtifacts : public testing::Test {
protected:
    template <class T>
    std::filesystem::path write(const std::string& name, const T& value)
    {
        write_artifact(folder_ / name, to_artifact(value));
        return folder_ / name;
    }

    static std::string text(const Comparison& comparison)
    {
        std::string all;
        for (const auto& line : comparison.lines)
            all += line + "\n";
        return all;
    }

    TemporaryFolder folder_;
};

TEST(MatchPlanes, FindsAngleAndOffsetOfAMovedBox)
{
    const PlaneMesh first = box({2, 3, 4}, 4);
    Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
    motion.rotate(Eigen::AngleAxisd(0.5 * kDegree, Eigen::Vector3d::UnitZ()));
    motion.pretranslate(Eigen::Vector3d(0, 0, 0.01));
    const PlaneMatches matches = match_planes(first, moved(first, motion));
    ASSERT_EQ(matches.pairs.size(), 6U);
    for (const auto& pair : matches.pairs) {
        EXPECT_EQ(pair.first, pair.second);
        const bool is_level = std::abs(first.plane[pair.first].normal.z()) > 0.5;
        EXPECT_NEAR(pair.angle, is_level ? 0.0 : 0.5 * kDegree, 1e-9);
        if (is_level) {
            EXPECT_NEAR(pair.offset, 0.01, 1e-9);
        }
    }
    EXPECT_TRUE(matches.only_first.empty() && matches.only_second.empty());
}

TEST(MatchPlanes, NamesPlanesThatOnlyOneHas)
{
    const PlaneMatches matches = match_planes(testing_support::room_corner(4), testing_support::l_corner(4));
    EXPECT_EQ(matches.pairs.size(), 2U);
    EXPECT_EQ(matches.only_first.size(), 1U);
    EXPECT_NEAR(matches.area_only_first, 1.0, 1e-6);
}

TEST_F(CompareArtifacts, EqualTensorsAreEqualWhoeverMadeThem)
{
    Artifact other = to_artifact(box({1, 1, 1}, 2));
    other.metadata["quoin.stage"] = "another";
    write_artifact(folder_ / "other", other);
    EXPECT_TRUE(compare_artifacts(write("one", box({1, 1, 1}, 2)), folder_ / "other").is_equal);
}

TEST_F(CompareArtifacts, SaysHowFarSurfacesAreApart)
{
    Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
    motion.pretranslate(Eigen::Vector3d(0, 0, 0.002));
    const PlaneMesh first = box({1, 1, 1}, 2);
    const Comparison comparison = compare_artifacts(write("one", first), write("two", moved(first, motion)));
    EXPECT_FALSE(comparison.is_equal);
    EXPECT_THAT(text(comparison), AllOf(HasSubstr("tensor position"), HasSubstr("planes 6, 6: 6 matched"),
                                        HasSubstr("largest 2.000 mm")));
}

TEST_F(CompareArtifacts, SaysThePsnrOfTexturePages)
{
    const auto textured = [](std::uint8_t grey) {
        TexturedMesh mesh;
        mesh.planes = testing_support::l_corner(1);
        mesh.uv = {{0, 0}, {1, 0}, {0, 1}};
        mesh.corner_uv.assign(mesh.planes.mesh.face.size(), {0, 1, 2});
        mesh.face_page.assign(mesh.planes.mesh.face.size(), 0);
        const Image<std::uint8_t> source(8, 8, 1);
        mesh.page.push_back({8, 8, encode_png(ColorImage(8, 8, {grey, grey, grey})), encode_png(source)});
        return mesh;
    };
    // 20 log10(255 / 5) = 34.15 dB
    EXPECT_THAT(text(compare_artifacts(write("one", textured(100)), write("two", textured(105)))),
                HasSubstr("page 0: PSNR 34.15 dB"));
}

TEST_F(CompareArtifacts, ComparesFiguresByName)
{
    const Metrics first{{"rms", "mm", 2.0, Better::Lower}, {"old", "", 1.0, Better::Neither}};
    const Metrics second{{"rms", "mm", 1.5, Better::Lower}, {"new", "", 1.0, Better::Neither}};
    EXPECT_THAT(text(compare_artifacts(write("one", first), write("two", second))),
                AllOf(HasSubstr("(better)"), HasSubstr("old"), HasSubstr("new")));
}

TEST_F(CompareArtifacts, RefusesTwoSchemas)
{
    const auto mesh = write("one", box({1, 1, 1}, 1));
    const auto metrics = write("two", Metrics{});
    EXPECT_THAT(test::error_of([&] { compare_artifacts(mesh, metrics); }, ExitCode::Input), HasSubstr("one schema"));
}

TEST_F(CompareArtifacts, TheDriverExitsWith0Or1)
{
    write("one", box({1, 1, 1}, 2));
    write("same", box({1, 1, 1}, 2));
    write("two", box({1, 1, 2}, 2));
    const auto diff = [&](const std::string& a, const std::string& b) {
        return test::run_command("cd '" + folder_.path().string() + "' && " QUOIN_BINARY_DIR "/bin/quoin diff " + a +
                                 " " + b);
    };
    EXPECT_EQ(diff("one", "same").exit_code, 0);
    EXPECT_EQ(diff("one", "two").exit_code, 1);
    EXPECT_EQ(diff("one", "absent").exit_code, 3);
    EXPECT_EQ(diff("one", "").exit_code, 2);
}

} // namespace
} // namespace quoin
