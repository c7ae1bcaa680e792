#include "pipeline/comparison.h"

#include <cmath>
#include <gmock/gmock.h>
#include <limits>

namespace quoin {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

Measurement measured(const std::string& variant, const std::string& scan, double error, double psnr)
{
    return {variant, scan, {{"geometry.rms", "mm", error, Better::Lower}, {"views.psnr", "dB", psnr, Better::Higher}}};
}

// Without lines every scan is worse by about a millimetre; the PSNR goes up and down.
std::vector<Measurement> three_scans()
{
    return {measured("baseline", "a", 4.0, 20),  measured("baseline", "b", 9.0, 25),
            measured("baseline", "c", 6.0, 22),  measured("no-lines", "a", 5.0, 21),
            measured("no-lines", "b", 10.1, 24), measured("no-lines", "c", 6.9, 22)};
}

TEST(Comparison, PairsEveryScanWithItselfInTheBaseline)
{
    const Comparison comparison = compare(three_scans(), {});
    EXPECT_THAT(comparison.variants, ElementsAre("baseline", "no-lines"));
    EXPECT_THAT(comparison.scans, ElementsAre("a", "b", "c"));
    const ComparedMetric& rms = comparison.metrics[0];
    EXPECT_NEAR(rms.figures[1]->mean, 22.0 / 3, 1e-12);
    EXPECT_NEAR(rms.figures[1]->difference.mean, 1.0, 1e-12);
    // The scans differ by millimetres, the differences by 0.1 mm: t = 4.303 times 0.1/sqrt(3).
    EXPECT_NEAR(*rms.figures[1]->difference.half_width, 4.3026527 * 0.1 / std::sqrt(3.0), 1e-6);
    EXPECT_EQ(verdict(rms, *rms.figures[1]), Verdict::Worse);
    EXPECT_EQ(verdict(comparison.metrics[1], *comparison.metrics[1].figures[1]), Verdict::Unclear);
}

TEST(Comparison, ComparesOnlyScansThatBothHave)
{
    auto measurements = three_scans();
    measurements[4].metrics.clear();
    measurements[5].metrics[0].value = std::numeric_limits<double>::quiet_NaN();
    const Comparison comparison = compare(measurements, {"geometry.*"});
    ASSERT_EQ(comparison.metrics.size(), 1U);
    EXPECT_EQ(comparison.metrics[0].figures[1]->scans, 1U);
    EXPECT_FALSE(comparison.metrics[0].figures[1]->difference.half_width.has_value());
}

TEST(Comparison, ShowsTheMetricsThatWereAskedForInTheirOrder)
{
    const Comparison comparison = compare(three_scans(), {"views.*", "geometry.rms", "*"});
    EXPECT_THAT(comparison.metrics[0].name, "views.psnr");
    EXPECT_EQ(comparison.metrics.size(), 2U);
}

TEST(Comparison, IsWrittenAsText)
{
    EXPECT_EQ(comparison_as_text(compare(three_scans(), {"geometry.*"})),
              "geometry.rms [mm], lower is better\n"
              "  variant          mean   difference  95 % interval            scans\n"
              "  baseline        6.333                                            3\n"
              "  no-lines        7.333           +1  [+0.7516, +1.248]            3  worse\n\n");
}

TEST(Comparison, IsWrittenAsCsv)
{
    const std::string csv = comparison_as_csv(compare(three_scans(), {"geometry.*"}));
    EXPECT_THAT(csv, HasSubstr("metric,unit,better,variant,scans,mean,difference,interval_low,interval_high\n"));
    EXPECT_THAT(csv, HasSubstr("\ngeometry.rms,mm,lower,baseline,3,6.3333"));
    EXPECT_THAT(measurements_as_csv(three_scans()), HasSubstr("\nno-lines,b,geometry.rms,mm,10.1\n"));
    EXPECT_THAT(measurements_as_csv({measured("x=1,y=\"2\"", "a", 1, 1)}),
                HasSubstr("\"x=1,y=\"\"2\"\"\",a,geometry.rms"));
}

TEST(Comparison, IsWrittenAsLatexThatItsSpecialLettersDoNotBreak)
{
    auto measurements = three_scans();
    measurements[3].variant = measurements[4].variant = measurements[5].variant = "max_error=5%";
    const std::string latex = comparison_as_latex(compare(measurements, {}));
    EXPECT_THAT(latex, AllOf(HasSubstr("\\begin{tabular}{lrr}"), HasSubstr("max\\_error=5\\%"),
                             HasSubstr("7.333 $(+1 \\pm 0.2484)$"), Not(HasSubstr("max_error"))));
}

TEST(Comparison, IsWrittenAsHtmlThatMarksWhatIsClear)
{
    auto measurements = three_scans();
    for (auto& measurement : measurements)
        if (measurement.variant == "no-lines") measurement.variant = "<no lines>";
    const std::string html = comparison_as_html(compare(measurements, {}));
    EXPECT_THAT(html,
                AllOf(HasSubstr("<td class=\"worse\">+1"), HasSubstr("&#60;no lines&#62;"), Not(HasSubstr("<no"))));
}

} // namespace
} // namespace quoin
