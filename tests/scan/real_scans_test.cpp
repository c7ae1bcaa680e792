// Real scans: right conventions give millimetres, and no other convention fits better.
#include "build_paths.h"
#include "scan/import.h"

#include <cstdlib>
#include <gtest/gtest.h>

namespace quoin {
namespace {

namespace fs = std::filesystem;

fs::path data_folder()
{
    const char* given = std::getenv("QUOIN_TEST_DATA");
    return given ? fs::path(given) : fs::path(QUOIN_SOURCE_DIR) / ".." / "shared" / "data";
}

struct RealScan {
    const char* name;
    Layout layout;
    double max_median; // [m]
};

class RealScans : public testing::TestWithParam<RealScan> {
protected:
    void SetUp() override
    {
        folder_ = data_folder() / GetParam().name;
        if (!fs::is_directory(folder_)) GTEST_SKIP() << "no scan at " << folder_ << "; set QUOIN_TEST_DATA";
        params_.max_frames = 60;
    }
    fs::path folder_;
    ImportParams params_;
};

TEST_P(RealScans, AgreeInDepthAndNeedNoOtherConvention)
{
    params_.layout = GetParam().layout;
    EXPECT_EQ(find_layout(folder_, Layout::Auto).layout, GetParam().layout);
    const ImportReport report = import_scan(folder_, params_).report;
    EXPECT_GT(report.check.samples, 1000u);
    EXPECT_LT(report.check.median, GetParam().max_median);
    EXPECT_EQ(report.suggestion, "");
}

TEST_P(RealScans, InvertedPosesAreNoticed)
{
    params_.pose = PoseDirection::WorldToCamera;
    EXPECT_EQ(import_scan(folder_, params_).report.suggestion, "--set pose=camera_to_world");
}

INSTANTIATE_TEST_SUITE_P(Folders, RealScans,
                         testing::Values(RealScan{"redkitchen", Layout::SevenScenes, 0.025},
                                         RealScan{"icl_of_kt0", Layout::IclNuim, 0.025},
                                         RealScan{"livingroom1", Layout::Redwood, 0.005},
                                         RealScan{"tum_fr3_structure", Layout::Tum, 0.015},
                                         RealScan{"tum_fr3_cabinet", Layout::Numbered, 0.02},
                                         RealScan{"chair_scan", Layout::ScannerApp, 0.01}),
                         [](const auto& scan) { return scan.param.name; });

} // namespace
} // namespace quoin
