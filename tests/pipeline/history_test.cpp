#include "pipeline/history.h"

#include "base/error.h"
#include "base/formula.h"

#include <gmock/gmock.h>

namespace quoin {
namespace {

double value_of(const std::string& formula)
{
    const FormulaSource source{
        .bytes = [](const std::string& port) { return port == "mesh" ? std::optional(1000.0) : std::nullopt; },
        .value = [](const std::string& name) { return name == "frames" ? std::optional(7.0) : std::nullopt; }};
    return evaluate_formula(formula, source).value_or(-1.0);
}

TEST(Formula, IsASumOfProducts)
{
    EXPECT_EQ(value_of("bytes(mesh) * 12 + 2K"), 14048.0);
    EXPECT_EQ(value_of("(1 + 2) * frames / 2 - 0.5"), 10.0);
    EXPECT_EQ(value_of("5G"), 5.0 * 1024 * 1024 * 1024);
}

TEST(Formula, IsUnknownWhenAPartOfItIs)
{
    EXPECT_EQ(value_of("bytes(lines) + 1"), -1.0);
    EXPECT_EQ(value_of("pixels * 2"), -1.0);
}

TEST(Formula, IsRefusedWhenItIsNone)
{
    for (const char* text : {"", "1 +", "bytes()", "bytes(mesh", "size(mesh)", "1 2", "*"})
        EXPECT_THROW(value_of(text), UsageError) << text;
}

StageDescription fuse()
{
    StageDescription stage;
    stage.name = "fuse";
    stage.impl_version = 2;
    stage.inputs = {{"scan", "scan", 1, false, ""}};
    stage.memory_formula = "bytes(scan) * 10";
    return stage;
}

PastRun past(int version, double seconds, std::uint64_t memory, std::uint64_t input)
{
    return {"fuse", version, seconds, memory, {{"scan", input}}, {{"mesh", 2 * input}}};
}

TEST(History, KnowsNothingButTheDeclaredMemoryAtFirst)
{
    const Estimate estimate = History({}).estimate(fuse(), {{"scan", 50}});
    EXPECT_FALSE(estimate.seconds.has_value());
    EXPECT_EQ(estimate.memory, 500U);
    EXPECT_FALSE(History({}).estimate(fuse(), {}).memory.has_value());
}

TEST(History, ScalesTheRunOfTheNearestSize)
{
    const History history({past(2, 10, 1000, 100), past(2, 90, 5000, 1000)});
    const Estimate estimate = history.estimate(fuse(), {{"scan", 200}});
    EXPECT_DOUBLE_EQ(*estimate.seconds, 20.0);
    EXPECT_EQ(estimate.memory, 2000U);
    EXPECT_EQ(estimate.outputs.at("mesh"), 400U);
    EXPECT_DOUBLE_EQ(*history.estimate(fuse(), {{"scan", 900}}).seconds, 81.0);
}

TEST(History, PrefersRunsOfTheSameVersion)
{
    const History history({past(1, 10, 1000, 100), past(2, 70, 5000, 1000)});
    EXPECT_DOUBLE_EQ(*history.estimate(fuse(), {{"scan", 100}}).seconds, 7.0);
}

TEST(History, NeverHalvesTheMemoryTwice)
{
    EXPECT_EQ(History({past(2, 10, 1000, 1000)}).estimate(fuse(), {{"scan", 10}}).memory, 500U);
}

} // namespace
} // namespace quoin
