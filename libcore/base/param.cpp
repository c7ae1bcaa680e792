#include "base/param.h"

#include "base/error.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

namespace quoin {
namespace {

template <class Number>
bool parse_number(std::string_view text, Number& value)
{
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size();
}

[[noreturn]] void refuse(const ParamSpec& spec, std::string_view text, std::string_view where,
                         const std::string& expected)
{
    throw UsageError(fmt::format("{}: parameter '{}' is '{}': expected {}", where, spec.name, text, expected));
}

std::string interval(const ParamSpec& spec)
{
    const std::string unit = spec.unit.empty() ? "" : " " + spec.unit;
    const bool low = std::isfinite(spec.min);
    const bool high = std::isfinite(spec.max);
    if (low && high) return fmt::format("from {} to {}{}", spec.min, spec.max, unit);
    if (low) return fmt::format("of at least {}{}", spec.min, unit);
    if (high) return fmt::format("of at most {}{}", spec.max, unit);
    return unit.empty() ? "" : "in" + unit;
}

void check_interval(const ParamSpec& spec, double value, std::string_view text, std::string_view where)
{
    const bool inside = value >= spec.min && value <= spec.max && std::isfinite(value);
    if (!inside) refuse(spec, text, where, fmt::format("a finite number {}", interval(spec)));
}

std::size_t edit_distance(std::string_view a, std::string_view b)
{
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), 0);
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replace = diagonal + (a[i - 1] != b[j - 1]);
            diagonal = row[j];
            row[j] = std::min({row[j] + 1, row[j - 1] + 1, replace});
        }
    }
    return row.back();
}

} // namespace

std::string_view type_name(ParamType type)
{
    constexpr std::string_view names[] = {"bool", "int", "float", "string", "choice"};
    return names[static_cast<int>(type)];
}

ParamValue parse_param(const ParamSpec& spec, std::string_view text, std::string_view where)
{
    switch (spec.type) {
    case ParamType::Bool:
        if (text == "true") return true;
        if (text == "false") return false;
        refuse(spec, text, where, "true or false");
    case ParamType::Int: {
        std::int64_t value = 0;
        if (!parse_number(text, value)) refuse(spec, text, where, "a whole number " + interval(spec));
        check_interval(spec, static_cast<double>(value), text, where);
        return value;
    }
    case ParamType::Float: {
        double value = 0.0;
        if (!parse_number(text, value)) refuse(spec, text, where, "a number " + interval(spec));
        check_interval(spec, value, text, where);
        return value == 0.0 ? 0.0 : value; // -0 and 0 are one value
    }
    case ParamType::Choice: {
        if (std::ranges::find(spec.choices, text) != spec.choices.end()) return std::string(text);
        const std::string near = nearest_name(text, spec.choices);
        refuse(spec, text, where,
               fmt::format("one of {}{}", fmt::join(spec.choices, ", "),
                           near.empty() ? "" : "; did you mean '" + near + "'?"));
    }
    case ParamType::String:
        return std::string(text);
    }
    return {};
}

std::string format_param(const ParamValue& value)
{
    if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
    if (const auto* text = std::get_if<std::string>(&value)) return *text;
    char buffer[64];
    const auto print = [&](auto number) {
        return std::string(buffer, std::to_chars(buffer, buffer + sizeof(buffer), number).ptr);
    };
    if (const auto* whole = std::get_if<std::int64_t>(&value)) return print(*whole);
    return print(std::get<double>(value));
}

std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates)
{
    std::string best;
    std::size_t best_distance = std::max<std::size_t>(2, name.size() / 3) + 1;
    for (const auto& candidate : candidates) {
        const std::size_t distance = edit_distance(name, candidate);
        if (distance < best_distance) {
            best = candidate;
            best_distance = distance;
        }
    }
    return best;
}

const ParamSpec& find_param(const std::vector<ParamSpec>& specs, std::string_view name, std::string_view where)
{
    std::vector<std::string> names;
    for (const auto& spec : specs) {
        if (spec.name == name) return spec;
        names.push_back(spec.name);
    }
    const std::string near = nearest_name(name, names);
    throw UsageError(fmt::format("{}: no parameter '{}'{}", where, name,
                                 near.empty() ? fmt::format("; there is: {}", fmt::join(names, ", "))
                                              : fmt::format("; did you mean '{}'?", near)));
}

} // namespace quoin
