#include "base/error.h"
#include "fusion/fuse.h"
#include "mesh/ply.h"
#include "scan/digest.h"

#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <span>
#include <unistd.h>

namespace quoin {
namespace {

using ::testing::HasSubstr;

// A scan folder with nothing but a mesh: a square of 2 x 2 m in 800 triangles, and a speck.
class DenseMesh : public ::testing::Test {
protected:
    DenseMesh() : root_(std::filesystem::temp_directory_path() / ("quoin_dense_mesh_" + std::to_string(getpid())))
    {
        std::filesystem::create_directories(root_);
        write_ply(root_ / "mesh.ply", square_and_speck());
        std::ifstream in(root_ / "mesh.ply", std::ios::binary);
        const std::string bytes{std::istreambuf_iterator<char>(in), {}};
        scan_.dense_mesh = {"mesh.ply", sha256(std::as_bytes(std::span(bytes)))};
    }
    ~DenseMesh() override { std::filesystem::remove_all(root_); }

    static TriangleMesh square_and_speck()
    {
        constexpr std::uint32_t kCells = 20;
        TriangleMesh mesh;
        for (std::uint32_t i = 0; i < (kCells + 1) * (kCells + 1); ++i)
            mesh.position.emplace_back(0.1f * float(i % (kCells + 1)), 0.1f * float(i / (kCells + 1)), 1.0f);
        for (std::uint32_t i = 0; i + kCells + 1 < mesh.position.size(); ++i) {
            if (i % (kCells + 1) == kCells) continue;
            mesh.face.push_back({i, i + 1, i + kCells + 1});
            mesh.face.push_back({i + 1, i + kCells + 2, i + kCells + 1});
        }
        const auto n = static_cast<VertexId>(mesh.position.size());
        mesh.position.insert(mesh.position.end(), {{5, 5, 5}, {5.01f, 5, 5}, {5, 5.01f, 5}});
        mesh.face.push_back({n, n + 1, n + 2});
        return mesh;
    }
    TriangleMesh fused(FuseSource source) const
    {
        FuseParams params;
        params.source = source;
        return fuse(ScanImages(scan_, root_), params);
    }

    std::filesystem::path root_;
    Scan scan_;
};

TEST_F(DenseMesh, OfTheScanIsTakenAndCleanedByDefault)
{
    const auto mesh = fused(FuseSource::Auto);
    EXPECT_EQ(mesh.face.size(), 800u);
    EXPECT_EQ(mesh.position.size(), 441u);
}

TEST_F(DenseMesh, IsIgnoredWhenFramesAreAskedFor) { EXPECT_THROW(fused(FuseSource::Frames), ImpossibleError); }

TEST_F(DenseMesh, ThatIsNotThereCannotBeAskedFor)
{
    scan_.dense_mesh.name.clear();
    EXPECT_THROW(fused(FuseSource::Mesh), InputError);
}

TEST_F(DenseMesh, ThatChangedSinceTheImportIsRefused)
{
    write_ply(root_ / "mesh.ply", TriangleMesh{});
    try {
        fused(FuseSource::Mesh);
        FAIL() << "no error";
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("mesh.ply"));
    }
}

} // namespace
} // namespace quoin
