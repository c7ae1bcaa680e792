#include "pipeline/comparison.h"

#include "pipeline/glob.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace quoin {
namespace {

using Values = std::map<std::string, double>; // by scan

struct Column {
    Metric first;                         // name, unit and direction
    std::map<std::string, Values> values; // by variant
};

template <class Range>
std::vector<std::string> in_order_of_coming(const Range& measurements, std::string Measurement::*name)
{
    std::vector<std::string> names;
    for (const auto& measurement : measurements)
        if (std::ranges::find(names, measurement.*name) == names.end()) names.push_back(measurement.*name);
    return names;
}

std::vector<Column> columns_of(const std::vector<Measurement>& measurements)
{
    std::vector<Column> columns;
    std::map<std::string, std::size_t> index;
    for (const auto& [variant, scan, metrics] : measurements)
        for (const auto& metric : metrics) {
            const auto [at, is_new] = index.emplace(metric.name, columns.size());
            if (is_new) columns.push_back({metric, {}});
            if (std::isfinite(metric.value)) columns[at->second].values[variant][scan] = metric.value;
        }
    return columns;
}

std::vector<Column> select(std::vector<Column> columns, const std::vector<std::string>& patterns)
{
    if (patterns.empty()) return columns;
    std::vector<Column> selected;
    std::set<std::string> taken;
    for (const auto& pattern : patterns)
        for (const auto& column : columns)
            if (matches(column.first.name, pattern) && taken.insert(column.first.name).second)
                selected.push_back(column);
    return selected;
}

std::optional<ComparedFigure> figure_of(const Values& base, const Values& values)
{
    if (values.empty()) return std::nullopt;
    ComparedFigure figure;
    std::vector<double> before;
    std::vector<double> after;
    for (const auto& [scan, value] : values) {
        figure.mean += value / static_cast<double>(values.size());
        if (const auto partner = base.find(scan); partner != base.end()) {
            before.push_back(partner->second);
            after.push_back(value);
        }
    }
    figure.scans = before.size();
    figure.difference = paired_difference(before, after);
    return figure;
}

} // namespace

Comparison compare(const std::vector<Measurement>& measurements, const std::vector<std::string>& patterns)
{
    Comparison comparison;
    comparison.variants = in_order_of_coming(measurements, &Measurement::variant);
    comparison.scans = in_order_of_coming(measurements, &Measurement::scan);
    if (measurements.empty()) return comparison;
    for (auto& column : select(columns_of(measurements), patterns)) {
        ComparedMetric metric{column.first.name, column.first.unit, column.first.better, {}};
        for (const auto& variant : comparison.variants)
            metric.figures.push_back(figure_of(column.values[comparison.variants.front()], column.values[variant]));
        comparison.metrics.push_back(std::move(metric));
    }
    return comparison;
}

Verdict verdict(const ComparedMetric& metric, const ComparedFigure& figure)
{
    const auto& [pairs, mean, half_width] = figure.difference;
    if (metric.better == Better::Neither || !half_width || std::abs(mean) <= *half_width) return Verdict::Unclear;
    return (mean < 0.0) == (metric.better == Better::Lower) ? Verdict::Better : Verdict::Worse;
}

} // namespace quoin
