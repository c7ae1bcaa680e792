#include "schema/filled_schema.h"
#include "schema/samples.h"
#include "support/expect_error.h"
#include "support/temporary_folder.h"

#include <gmock/gmock.h>

namespace quoin {
namespace {

using namespace test;
using testing::HasSubstr;

TEST(FilledSchema, KeepsTheMarksBesideTheMesh)
{
    const TemporaryFolder folder;
    std::vector<std::uint8_t> marks(sample_textured_mesh().planes.mesh.face.size(), 0);
    marks.back() = 1;
    write_artifact(folder / "textured.safetensors", to_artifact(Filled<TexturedMesh>{sample_textured_mesh(), marks}));
    EXPECT_EQ(read_face_filled(folder / "textured.safetensors"), marks);
    EXPECT_EQ(to_artifact(read_textured_mesh(folder / "textured.safetensors")).payload(),
              to_artifact(sample_textured_mesh()).payload());
}

TEST(FilledSchema, IsOptional)
{
    const TemporaryFolder folder;
    write_artifact(folder / "planes.safetensors", to_artifact(sample_plane_mesh()));
    EXPECT_TRUE(read_face_filled(folder / "planes.safetensors").empty());
    EXPECT_EQ(to_artifact(Filled<PlaneMesh>{sample_plane_mesh(), {}}).payload(),
              to_artifact(sample_plane_mesh()).payload());
}

TEST(FilledSchema, RefusesMarksForOtherFaces)
{
    const TemporaryFolder folder;
    const std::vector<std::uint8_t> marks(sample_plane_mesh().mesh.face.size() + 1, 0);
    write_artifact(folder / "planes.safetensors", to_artifact(Filled<PlaneMesh>{sample_plane_mesh(), marks}));
    EXPECT_THAT(error_of([&] { read_face_filled(folder / "planes.safetensors"); }, ExitCode::Input),
                HasSubstr("face_filled"));
}

} // namespace
} // namespace quoin
