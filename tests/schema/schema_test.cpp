#include "base/atomic_file.h"
#include "build_paths.h"
#include "schema/samples.h"
#include "support/expect_error.h"
#include "support/temporary_folder.h"

#include <cstdlib>
#include <gmock/gmock.h>

namespace quoin {
namespace {

using namespace test;
using ::testing::HasSubstr;

// A schema with its sample and its reader; reading gives back an artifact so that all schemas compare alike.
struct Case {
    const char* schema;
    Artifact sample;
    std::function<Artifact(const std::filesystem::path&)> reread;
};

std::vector<Case> cases()
{
    return {
        {"scan", to_artifact(sample_scan()), [](const auto& p) { return to_artifact(read_scan(p)); }},
        {"mesh", to_artifact(sample_mesh()), [](const auto& p) { return to_artifact(read_mesh(p)); }},
        {"keyframes", to_artifact(sample_keyframes()), [](const auto& p) { return to_artifact(read_keyframes(p)); }},
        {"plane_mesh", to_artifact(sample_plane_mesh()), [](const auto& p) { return to_artifact(read_plane_mesh(p)); }},
        {"lines", to_artifact(sample_lines()), [](const auto& p) { return to_artifact(read_lines(p)); }},
        {"alignment", to_artifact(sample_alignment()), [](const auto& p) { return to_artifact(read_alignment(p)); }},
        {"textured_mesh", to_artifact(sample_textured_mesh()),
         [](const auto& p) { return to_artifact(read_textured_mesh(p)); }},
        {"metrics", to_artifact(sample_metrics()), [](const auto& p) { return to_artifact(read_metrics(p)); }},
    };
}

std::filesystem::path golden_file(const Case& c)
{
    return std::filesystem::path(QUOIN_SOURCE_DIR) / "tests/schema/golden" / (std::string(c.schema) + "-1.safetensors");
}

TEST(Schema, EveryValueSurvivesARoundTrip)
{
    const TemporaryFolder folder;
    for (const auto& c : cases()) {
        const auto file = folder / c.schema;
        write_artifact(file, c.sample);
        const Artifact again = c.reread(file);
        EXPECT_EQ(again.schema, c.schema);
        EXPECT_EQ(again.payload(), c.sample.payload()) << c.schema;
    }
}

TEST(Schema, VignettingIsWrittenWhereThereIsSome)
{
    const TemporaryFolder folder;
    Alignment alignment = sample_alignment();
    EXPECT_FALSE(to_artifact(alignment).tensors.contains("vignetting"));
    alignment.vignetting.k = {0.25f, 0.125f, -0.5f};
    write_artifact(folder / "a", to_artifact(alignment));
    EXPECT_EQ(read_alignment(folder / "a").vignetting.k, alignment.vignetting.k);
}

TEST(Schema, ScoresOfHeldOutTexelsAreWrittenWhereThereAreSome)
{
    const TemporaryFolder folder;
    Alignment alignment = sample_alignment();
    write_artifact(folder / "a", to_artifact(alignment));
    EXPECT_FALSE(read_alignment(folder / "a").held_out);
    alignment.held_out = {4.5, 6.25, true};
    write_artifact(folder / "b", to_artifact(alignment));
    const auto scores = read_alignment(folder / "b").held_out;
    ASSERT_TRUE(scores);
    EXPECT_EQ(scores->input, 4.5);
    EXPECT_EQ(scores->optimized, 6.25);
    EXPECT_TRUE(scores->is_input_kept);
}

// The files of version 1 as the first release wrote them. To add a version, run with QUOIN_WRITE_GOLDEN=1 and commit
// the new file.
TEST(Schema, GoldenFilesAreReadAndWrittenByteForByte)
{
    const TemporaryFolder folder;
    for (const auto& c : cases()) {
        if (std::getenv("QUOIN_WRITE_GOLDEN") != nullptr && !std::filesystem::exists(golden_file(c)))
            write_artifact(golden_file(c), c.sample);
        EXPECT_EQ(c.reread(golden_file(c)).payload(), c.sample.payload()) << c.schema;
        write_artifact(folder / c.schema, c.sample);
        EXPECT_EQ(read_text(folder / c.schema), read_text(golden_file(c))) << c.schema;
    }
}

TEST(Schema, EveryMissingTensorIsNamed)
{
    const TemporaryFolder folder;
    for (const auto& c : cases()) {
        for (const auto& [name, tensor] : c.sample.tensors) {
            if (name == "color" || name == "dense_mesh.sha256" || name == "dense_mesh.file")
                continue; // optional, and its pair
            Artifact without = c.sample;
            without.tensors.erase(name);
            write_artifact(folder / "a", without);
            EXPECT_THAT(error_of([&] { c.reread(folder / "a"); }, ExitCode::Input), HasSubstr(name)) << c.schema;
        }
    }
}

TEST(Schema, EveryWrongShapeOrTypeIsNamed)
{
    const TemporaryFolder folder;
    for (const auto& c : cases()) {
        for (const auto& [name, tensor] : c.sample.tensors) {
            Artifact wrong = c.sample;
            wrong.tensors[name].type = DType::I16;
            wrong.tensors[name].shape = {tensor.bytes.size() / 2};
            wrong.tensors[name].bytes = tensor.bytes.first(tensor.bytes.size() / 2 * 2);
            write_artifact(folder / "a", wrong);
            EXPECT_THAT(error_of([&] { c.reread(folder / "a"); }, ExitCode::Input), HasSubstr(name)) << c.schema;
        }
    }
}

// What reading says after one tensor was replaced.
template <class Element, class T>
std::string refusal(const Case& c, const std::string& name, std::vector<std::size_t> shape,
                    const std::vector<T>& values)
{
    const TemporaryFolder folder;
    Artifact wrong = c.sample;
    wrong.add<Element>(name, std::move(shape), values);
    write_artifact(folder / "a", wrong);
    return error_of([&] { c.reread(folder / "a"); }, ExitCode::Input);
}

TEST(Schema, IndicesOutOfRangeAreRefused)
{
    const auto all = cases();
    EXPECT_THAT((refusal<std::uint32_t, std::uint32_t>(all[1], "face", {1, 3}, {0, 1, 4})), HasSubstr("below 4"));
    EXPECT_THAT((refusal<std::uint32_t, std::uint32_t>(all[2], "frame", {1}, {3})), HasSubstr("below 3"));
    EXPECT_THAT((refusal<std::uint32_t, std::uint32_t>(all[2], "frame", {2}, {2, 2})), HasSubstr("ascending"));
    EXPECT_THAT((refusal<std::uint32_t, std::uint32_t>(all[3], "face_plane", {2}, {0, 2})), HasSubstr("below 2"));
    EXPECT_THAT((refusal<std::uint8_t, std::uint8_t>(all[3], "vertex_class", {4}, {0, 1, 2, 3})), HasSubstr("above 2"));
    EXPECT_THAT((refusal<std::uint32_t, std::uint32_t>(all[6], "face_page", {2}, {0, 1})), HasSubstr("below 1"));
    EXPECT_THAT((refusal<std::uint8_t, std::uint8_t>(all[0], "valid", {2}, {1, 3})), HasSubstr("expected 0, 1 or 2"));
}

TEST(Schema, NumbersThatAreNoNumbersAreRefused)
{
    const auto all = cases();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THAT((refusal<float, float>(all[1], "position", {4, 3}, std::vector<float>(12, nan))),
                HasSubstr("not finite"));
    EXPECT_THAT((refusal<double, double>(all[3], "plane", {2, 4}, {2, 0, 0, 1, 0, 1, 0, 1})), HasSubstr("unit length"));
    EXPECT_THAT((refusal<double, double>(all[0], "camera_from_world", {2, 4, 4}, std::vector<double>(32, 0.5))),
                HasSubstr("rigid"));
}

TEST(Schema, UnknownTensorsAreCarriedByTheContainer)
{
    const TemporaryFolder folder;
    Artifact more = to_artifact(sample_mesh());
    more.add<float>("my.curvature", {4}, std::vector<float>{1, 2, 3, 4});
    write_artifact(folder / "a", more);
    EXPECT_EQ(read_mesh(folder / "a").face.size(), 2u);
    EXPECT_TRUE(read_artifact(folder / "a").tensors.contains("my.curvature"));
}

} // namespace
} // namespace quoin
