#include "simplify/cut_off.h"

#include "mesh/adjacency.h"
#include "support/plane_meshes.h"

#include <gmock/gmock.h>

namespace quoin {
namespace {

using namespace testing_support;
using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

// Squares of two faces each, side by side: what is taken out of `zone` leaves its neighbours beside the cut.
struct Sheet {
    PlaneMesh mesh;
    std::vector<std::uint32_t> opposite, mark;
    int cells;

    explicit Sheet(int n)
        : mesh(join_sheets({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, n}})), opposite(opposite_half_edges(mesh.mesh)),
          mark(mesh.mesh.face.size(), 0), cells(n)
    {
    }

    void take_out(int i, int j)
    {
        for (int half = 0; half < 2; ++half)
            mesh.face_plane[static_cast<std::size_t>(2 * (cells * j + i) + half)] = 1;
    }

    std::vector<std::vector<FaceId>> cut_off()
    {
        std::vector<FaceId> beside;
        for (std::uint32_t h = 0; h < opposite.size(); ++h)
            if (is_half_edge(opposite[h]) && mesh.face_plane[h / 3] == 1 && mesh.face_plane[opposite[h] / 3] == 0)
                beside.push_back(opposite[h] / 3);
        return cut_off_pieces(mesh.face_plane, opposite, beside, mark);
    }
};

TEST(CutOff, IsNothingAroundAHole)
{
    Sheet sheet(20);
    sheet.take_out(7, 9);
    EXPECT_THAT(sheet.cut_off(), IsEmpty());
    EXPECT_THAT(sheet.mark, Each(0u));
}

TEST(CutOff, IsTheSmallerSideOfACutThroughAll)
{
    Sheet sheet(20);
    for (int j = 0; j < 20; ++j)
        sheet.take_out(5, j);
    const auto pieces = sheet.cut_off();
    ASSERT_THAT(pieces, ElementsAre(SizeIs(5 * 20 * 2)));
    EXPECT_TRUE(std::ranges::is_sorted(pieces[0]));
    EXPECT_THAT(sheet.mark, Each(0u));
}

TEST(CutOff, IsAllButTheLargestOfManyPieces)
{
    Sheet sheet(9);
    for (int k = 0; k < 9; ++k)
        for (const int line : {2, 4}) {
            sheet.take_out(line, k);
            sheet.take_out(k, line);
        }
    const auto pieces = sheet.cut_off(); // widths 2, 1, 4 both ways; the largest is 4 x 4 cells
    std::vector<std::size_t> sizes;
    for (const auto& piece : pieces)
        sizes.push_back(piece.size() / 2);
    EXPECT_THAT(sizes, testing::UnorderedElementsAre(4, 2, 8, 2, 1, 4, 8, 4));
}

TEST(CutOff, IsNothingWhereNothingIsLeft)
{
    Sheet sheet(1);
    sheet.take_out(0, 0);
    EXPECT_THAT(sheet.cut_off(), IsEmpty());
}

} // namespace
} // namespace quoin
