#include "pipeline/text_figures.h"

#include "base/error.h"

#include <gtest/gtest.h>

namespace quoin {
namespace {

TEST(TextFigures, ShowsDurationsInFittingUnits)
{
    EXPECT_EQ(duration_text(0.214), "0.21 s");
    EXPECT_EQ(duration_text(42.31), "42.3 s");
    EXPECT_EQ(duration_text(187.0), "3:07 min");
    EXPECT_EQ(duration_text(3727.0), "1:02:07 h");
}

TEST(TextFigures, ShowsBytesInFittingUnits)
{
    EXPECT_EQ(bytes_text(512), "512 B");
    EXPECT_EQ(bytes_text(1'400'000), "1.4 MB");
    EXPECT_EQ(bytes_text(23'000'000'000), "23 GB");
}

TEST(TextFigures, ReadsSizes)
{
    EXPECT_EQ(parse_bytes("4G", "--memory"), 4ULL << 30);
    EXPECT_EQ(parse_bytes("1.5M", "--memory"), 3ULL << 19);
    EXPECT_EQ(parse_bytes("800", "--memory"), 800U);
    for (const char* text : {"", "G", "-1G", "4X", "4GG", "nan", "0"})
        EXPECT_THROW(parse_bytes(text, "--memory"), UsageError) << text;
}

} // namespace
} // namespace quoin
