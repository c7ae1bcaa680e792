#include "alignment/held_out.h"

#include "textured_room.h"

#include <gtest/gtest.h>
#include <map>
#include <numeric>

namespace quoin {
namespace {

using Place = std::tuple<PlaneId, int, int>; // in steps of the finest grid

std::map<Place, bool> held_out_places(const PlaneMesh& mesh, const OptimizeTextureParams& params, int step)
{
    const Texels texels = sample_texels(mesh, params.texel_size * params.texel_stride * step);
    const auto is_held_out = held_out_texels(texels, params);
    std::map<Place, bool> places;
    for (TexelId t = 0; t < texels.size(); ++t)
        places[{texels.plane[t], step * texels.cell[t][0], step * texels.cell[t][1]}] = is_held_out[t] != 0;
    return places;
}

TEST(HeldOut, IsTheGivenPartOfEveryPlane)
{
    const PlaneMesh mesh = testing::room_mesh({});
    for (const double part : {0.0, 0.1, 0.5}) {
        OptimizeTextureParams params;
        params.held_out = part;
        std::map<PlaneId, std::pair<double, double>> counts; // held out, all
        for (const auto& [place, is_held_out] : held_out_places(mesh, params, 1)) {
            counts[std::get<0>(place)].first += is_held_out;
            counts[std::get<0>(place)].second += 1.0;
        }
        ASSERT_EQ(counts.size(), 6u);
        for (const auto& [plane, count] : counts)
            EXPECT_NEAR(count.first / count.second, part, 0.02) << plane;
    }
}

TEST(HeldOut, IsTheSamePlacesAtEverySpacing)
{
    const PlaneMesh mesh = testing::room_mesh({});
    const OptimizeTextureParams params;
    const auto finest = held_out_places(mesh, params, 1);
    for (const int step : {2, 4}) {
        std::size_t shared = 0;
        for (const auto& [place, is_held_out] : held_out_places(mesh, params, step)) {
            const auto same = finest.find(place);
            if (same == finest.end()) continue; // on the border, which roundings decide
            EXPECT_EQ(is_held_out, same->second);
            ++shared;
        }
        EXPECT_GT(shared, 1000u);
    }
}

} // namespace
} // namespace quoin
