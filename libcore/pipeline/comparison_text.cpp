// Comparisons as text, CSV, LaTeX and HTML.
#include "pipeline/comparison.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>

namespace quoin {
namespace {

constexpr int kDigits = 4; // significant; measurements on a few scans hold no more

std::string number(double value) { return fmt::format("{:.{}g}", value, kDigits); }
std::string signed_number(double value) { return fmt::format("{:+.{}g}", value, kDigits); }

std::string unit_text(const ComparedMetric& metric) { return metric.unit.empty() ? "" : " [" + metric.unit + "]"; }

const char* better_text(Better better)
{
    constexpr const char* texts[] = {"lower", "higher", ""};
    return texts[static_cast<int>(better)];
}

const char* verdict_text(Verdict verdict)
{
    constexpr const char* texts[] = {"", "better", "worse"};
    return texts[static_cast<int>(verdict)];
}

std::string interval_text(const PairedDifference& difference)
{
    if (!difference.half_width) return "";
    return fmt::format("[{}, {}]", signed_number(difference.mean - *difference.half_width),
                       signed_number(difference.mean + *difference.half_width));
}

std::string title(const ComparedMetric& metric)
{
    const std::string better = better_text(metric.better);
    return metric.name + unit_text(metric) + (better.empty() ? "" : ", " + better + " is better");
}

std::size_t name_width(const Comparison& comparison)
{
    std::size_t width = 0;
    for (const auto& variant : comparison.variants)
        width = std::max(width, variant.size());
    return width;
}

std::string csv_field(const std::string& text)
{
    if (text.find_first_of(",\"\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text)
        quoted += c == '"' ? "\"\"" : std::string(1, c);
    return quoted + "\"";
}

std::string escaped(const std::string& text, const std::string& special, const auto& escape)
{
    std::string result;
    for (const char c : text)
        result += special.find(c) == std::string::npos ? std::string(1, c) : escape(c);
    return result;
}

std::string latex_text(const std::string& text)
{
    return escaped(text, "_%&#$^{}\\~", [](char c) {
        return c == '\\'              ? std::string("\\textbackslash{}")
               : c == '^' || c == '~' ? fmt::format("\\{}{{}}", c)
                                      : fmt::format("\\{}", c);
    });
}

std::string html_text(const std::string& text)
{
    return escaped(text, "<>&\"", [](char c) { return fmt::format("&#{};", static_cast<int>(c)); });
}

std::string latex_cell(const ComparedMetric& metric, const std::optional<ComparedFigure>& figure, bool is_baseline)
{
    if (!figure) return "--";
    if (is_baseline) return number(figure->mean);
    const auto& [pairs, mean, half_width] = figure->difference;
    std::string difference = signed_number(mean);
    if (half_width) difference += fmt::format(" \\pm {}", number(*half_width));
    const Verdict found = verdict(metric, *figure);
    const std::string cell = fmt::format("{} $({})$", number(figure->mean), difference);
    return found == Verdict::Better ? "\\textbf{" + cell + "}" : cell;
}

// A table stays within a page.
constexpr std::size_t kMetricsPerTable = 4;

std::string latex_table(const Comparison& comparison, std::size_t begin, std::size_t end)
{
    std::string text = "\\begin{tabular}{l" + std::string(end - begin, 'r') + "}\n\\hline\nvariant";
    for (std::size_t m = begin; m < end; ++m)
        text += " & " + latex_text(comparison.metrics[m].name + unit_text(comparison.metrics[m]));
    text += " \\\\\n\\hline\n";
    for (std::size_t v = 0; v < comparison.variants.size(); ++v) {
        text += latex_text(comparison.variants[v]);
        for (std::size_t m = begin; m < end; ++m)
            text += " & " + latex_cell(comparison.metrics[m], comparison.metrics[m].figures[v], v == 0);
        text += " \\\\\n";
    }
    return text + "\\hline\n\\end{tabular}\n";
}

constexpr const char* kHtmlHead = R"(<!doctype html>
<meta charset="utf-8">
<title>Ablation</title>
<style>
body { font: 15px/1.5 system-ui, sans-serif; margin: 2em auto; max-width: 60em; padding: 0 1em; color: #222; }
table { border-collapse: collapse; margin: 0 0 1.5em; }
th, td { padding: .15em .8em; text-align: right; border-bottom: 1px solid #ddd; font-variant-numeric: tabular-nums; }
th:first-child, td:first-child { text-align: left; }
h2 { font-size: 1.05em; margin: 1.5em 0 .3em; }
.better { color: #0a6b2d; font-weight: 600; }
.worse { color: #a8201a; font-weight: 600; }
</style>
<h1>Ablation</h1>
)";

std::string html_row(const ComparedMetric& metric, const std::string& variant,
                     const std::optional<ComparedFigure>& figure, bool is_baseline)
{
    if (!figure) return fmt::format("<tr><td>{}<td><td><td><td>\n", html_text(variant));
    if (is_baseline) return fmt::format("<tr><td>{}<td>{}<td><td><td>\n", html_text(variant), number(figure->mean));
    const char* found = verdict_text(verdict(metric, *figure));
    return fmt::format("<tr><td>{0}<td>{1}<td class=\"{2}\">{3}<td>{4}<td class=\"{2}\">{2}\n", html_text(variant),
                       number(figure->mean), found, signed_number(figure->difference.mean),
                       interval_text(figure->difference));
}

} // namespace

std::string comparison_as_text(const Comparison& comparison)
{
    const std::size_t width = name_width(comparison);
    std::string text;
    const auto out = std::back_inserter(text);
    for (const auto& metric : comparison.metrics) {
        fmt::format_to(out, "{}\n  {:<{}} {:>12} {:>12}  {:<24} {:>5}\n", title(metric), "variant", width, "mean",
                       "difference", "95 % interval", "scans");
        for (std::size_t v = 0; v < comparison.variants.size(); ++v) {
            const auto& figure = metric.figures[v];
            fmt::format_to(out, "  {:<{}}", comparison.variants[v], width);
            if (!figure)
                fmt::format_to(out, " {:>12}", "-");
            else if (v == 0)
                fmt::format_to(out, " {:>12} {:>12}  {:<24} {:>5}", number(figure->mean), "", "", figure->scans);
            else
                fmt::format_to(out, " {:>12} {:>12}  {:<24} {:>5}  {}", number(figure->mean),
                               signed_number(figure->difference.mean), interval_text(figure->difference), figure->scans,
                               verdict_text(verdict(metric, *figure)));
            text.erase(text.find_last_not_of(' ') + 1);
            text += '\n';
        }
        text += '\n';
    }
    return text;
}

std::string comparison_as_csv(const Comparison& comparison)
{
    std::string text = "metric,unit,better,variant,scans,mean,difference,interval_low,interval_high\n";
    for (const auto& metric : comparison.metrics)
        for (std::size_t v = 0; v < comparison.variants.size(); ++v) {
            if (!metric.figures[v]) continue;
            const auto& [scans, mean, difference] = *metric.figures[v];
            text += fmt::format("{},{},{},{},{},{}", csv_field(metric.name), csv_field(metric.unit),
                                better_text(metric.better), csv_field(comparison.variants[v]), scans, mean);
            text += v == 0 ? ",," : fmt::format(",{},", difference.mean);
            if (v > 0 && difference.half_width)
                text += fmt::format("{},{}\n", difference.mean - *difference.half_width,
                                    difference.mean + *difference.half_width);
            else
                text += ",\n";
        }
    return text;
}

std::string comparison_as_latex(const Comparison& comparison)
{
    std::string text =
        fmt::format("% mean over {} scans (paired difference to {}, 95 \\% confidence interval)\n",
                    comparison.scans.size(), comparison.variants.empty() ? "" : comparison.variants.front());
    for (std::size_t begin = 0; begin < comparison.metrics.size(); begin += kMetricsPerTable)
        text += latex_table(comparison, begin, std::min(comparison.metrics.size(), begin + kMetricsPerTable));
    return text;
}

std::string comparison_as_html(const Comparison& comparison)
{
    std::string text = kHtmlHead;
    text +=
        fmt::format("<p>{} scans: {}. Differences are paired: the mean over the scans of variant minus {}, with its "
                    "95 % confidence interval (Student's t).</p>\n",
                    comparison.scans.size(), html_text(fmt::format("{}", fmt::join(comparison.scans, ", "))),
                    comparison.variants.empty() ? "baseline" : html_text(comparison.variants.front()));
    for (const auto& metric : comparison.metrics) {
        text += fmt::format("<h2>{}</h2>\n<table>\n<tr><th>variant<th>mean<th>difference<th>95 % interval<th>\n",
                            html_text(title(metric)));
        for (std::size_t v = 0; v < comparison.variants.size(); ++v)
            text += html_row(metric, comparison.variants[v], metric.figures[v], v == 0);
        text += "</table>\n";
    }
    return text;
}

std::string measurements_as_csv(const std::vector<Measurement>& measurements)
{
    std::string text = "variant,scan,metric,unit,value\n";
    for (const auto& [variant, scan, metrics] : measurements)
        for (const auto& metric : metrics)
            text += fmt::format("{},{},{},{},{}\n", csv_field(variant), csv_field(scan), csv_field(metric.name),
                                csv_field(metric.unit), metric.value);
    return text;
}

} // namespace quoin
