#include "base/param.h"
#include "support/expect_error.h"

#include <array>
#include <cmath>

namespace quoin {
namespace {

using test::error_of;
using testing::HasSubstr;

enum class Method { Heap, Hybrid };
constexpr auto choice_names(Method) { return std::array{"heap", "hybrid"}; }

struct SomeParams {
    double max_error = 0.008;
    int rounds = 3;
    bool swap = true;
    Method method = Method::Hybrid;
    std::string mesh = "auto";

    static constexpr auto list()
    {
        using P = SomeParams;
        return std::tuple{
            Param{"max_error", &P::max_error, "m", "largest distance", 0.0, 1.0},
            Param{"rounds", &P::rounds, "", "number of rounds", 1.0},
            Param{"swap", &P::swap, "", "exchange faces"},
            Param{"method", &P::method, "", "how it is done"},
            Param{"mesh", &P::mesh, "", "a file"},
        };
    }
};

ParamValue parse(const char* name, const char* text)
{
    const auto specs = specs_of<SomeParams>();
    return parse_param(find_param(specs, name, "--set"), text, "--set");
}

std::string refusal(const char* name, const char* text)
{
    return error_of([&] { parse(name, text); }, ExitCode::Usage);
}

TEST(Params, ListTellsTypeDefaultUnitAndInterval)
{
    const auto specs = specs_of<SomeParams>();
    ASSERT_EQ(specs.size(), 5u);
    EXPECT_EQ(specs[0].type, ParamType::Float);
    EXPECT_EQ(std::get<double>(specs[0].default_value), 0.008);
    EXPECT_EQ(specs[0].unit, "m");
    EXPECT_EQ(specs[0].max, 1.0);
    EXPECT_EQ(specs[1].type, ParamType::Int);
    EXPECT_EQ(specs[2].type, ParamType::Bool);
    EXPECT_EQ(specs[3].type, ParamType::Choice);
    EXPECT_EQ(std::get<std::string>(specs[3].default_value), "hybrid");
    EXPECT_THAT(specs[3].choices, testing::ElementsAre("heap", "hybrid"));
    EXPECT_EQ(specs[4].type, ParamType::String);
}

TEST(Params, ParsedValuesReachTheStruct)
{
    const ParamValues values{{"max_error", parse("max_error", "0.25")},
                             {"rounds", parse("rounds", "7")},
                             {"swap", parse("swap", "false")},
                             {"method", parse("method", "heap")},
                             {"mesh", parse("mesh", "a.ply")}};
    const auto params = params_from<SomeParams>(values);
    EXPECT_EQ(params.max_error, 0.25);
    EXPECT_EQ(params.rounds, 7);
    EXPECT_FALSE(params.swap);
    EXPECT_EQ(params.method, Method::Heap);
    EXPECT_EQ(params.mesh, "a.ply");
}

TEST(Params, WhatIsNotGivenKeepsItsDefault)
{
    const auto params = params_from<SomeParams>({{"rounds", std::int64_t{9}}});
    EXPECT_EQ(params.rounds, 9);
    EXPECT_EQ(params.max_error, 0.008);
    EXPECT_EQ(params.method, Method::Hybrid);
}

TEST(Params, TextThatIsNoNumberIsRefusedWithNameAndValue)
{
    EXPECT_THAT(refusal("max_error", "wide"),
                testing::AllOf(HasSubstr("max_error"), HasSubstr("wide"), HasSubstr("number")));
    EXPECT_THAT(refusal("rounds", "2.5"), HasSubstr("whole number"));
    EXPECT_THAT(refusal("rounds", "3x"), HasSubstr("3x"));
    EXPECT_THAT(refusal("swap", "1"), HasSubstr("true or false"));
}

TEST(Params, NumbersOutsideTheIntervalAreRefusedNaNAndInfinityToo)
{
    for (const char* text : {"1.01", "-0.1", "nan", "inf", "-inf", "1e999"})
        EXPECT_THAT(refusal("max_error", text), HasSubstr("from 0 to 1 m")) << text;
    EXPECT_THAT(refusal("rounds", "0"), HasSubstr("at least 1"));
}

TEST(Params, EndsOfTheIntervalBelongToIt)
{
    EXPECT_EQ(std::get<double>(parse("max_error", "0")), 0.0);
    EXPECT_EQ(std::get<double>(parse("max_error", "1")), 1.0);
}

TEST(Params, MinusZeroIsZeroSoThatCacheKeysAgree)
{
    EXPECT_FALSE(std::signbit(std::get<double>(parse("max_error", "-0.0"))));
}

TEST(Params, UnknownChoiceListsTheChoices) { EXPECT_THAT(refusal("method", "quick"), HasSubstr("heap, hybrid")); }

TEST(Params, UnknownNameSuggestsTheNearestOne)
{
    EXPECT_THAT(refusal("max_eror", "1"), HasSubstr("did you mean 'max_error'"));
    EXPECT_THAT(refusal("zzzzzzzzz", "1"), HasSubstr("there is: max_error, rounds"));
}

TEST(Params, FormattedValuesParseBackToThemselves)
{
    for (const double value : {0.1, 1.0 / 3.0, 1e-9, 0.0002})
        EXPECT_EQ(std::get<double>(parse("max_error", format_param(value).c_str())), value);
    EXPECT_EQ(format_param(true), "true");
    EXPECT_EQ(format_param(std::int64_t{-4}), "-4");
}

TEST(NearestName, TakesTheLeastEditDistanceAndNothingFar)
{
    EXPECT_EQ(nearest_name("merg", {"simplify", "merge"}), "merge");
    EXPECT_EQ(nearest_name("texture", {"simplify", "merge"}), "");
}

} // namespace
} // namespace quoin
