#include "foreign/variations.h"

#include <algorithm>
#include <cmath>

namespace quoin {
namespace {

std::string number_text(const ParamSpec& spec, double value)
{
    return format_param(spec.type == ParamType::Int ? ParamValue(static_cast<std::int64_t>(value)) : ParamValue(value));
}

double default_number(const ParamSpec& spec)
{
    return spec.type == ParamType::Int ? static_cast<double>(std::get<std::int64_t>(spec.default_value))
                                       : std::get<double>(spec.default_value);
}

} // namespace

std::string misspelt(const std::string& name, const std::vector<ParamSpec>& params)
{
    std::string wrong = name.size() > 3 ? name.substr(0, name.size() - 1) : name + "x";
    while (std::ranges::find(params, wrong, &ParamSpec::name) != params.end())
        wrong += "x";
    return wrong;
}

std::vector<std::string> texts_out_of_range(const ParamSpec& spec)
{
    std::vector<std::string> texts;
    if (spec.type != ParamType::Int && spec.type != ParamType::Float) return texts;
    const auto step = [](double bound) { return std::max(1.0, std::abs(bound)); };
    if (std::isfinite(spec.min)) texts.push_back(number_text(spec, spec.min - step(spec.min)));
    if (std::isfinite(spec.max)) texts.push_back(number_text(spec, spec.max + step(spec.max)));
    if (spec.type == ParamType::Float) texts.emplace_back("nan");
    return texts;
}

std::optional<std::string> other_value(const ParamSpec& spec)
{
    if (spec.type == ParamType::Bool) return std::get<bool>(spec.default_value) ? "false" : "true";
    if (spec.type == ParamType::String) return std::get<std::string>(spec.default_value) + "x";
    if (spec.type == ParamType::Choice) {
        for (const auto& choice : spec.choices)
            if (choice != std::get<std::string>(spec.default_value)) return choice;
        return std::nullopt;
    }
    const double now = default_number(spec);
    for (const double other : {now + 1.0, now - 1.0, 0.5 * (now + spec.min), 0.5 * (now + spec.max)})
        if (std::isfinite(other) && other >= spec.min && other <= spec.max &&
            number_text(spec, other) != number_text(spec, now))
            return number_text(spec, other);
    return std::nullopt;
}

std::vector<std::string> reordered(const std::vector<std::string>& arguments)
{
    std::vector<std::string> result;
    for (std::size_t i = arguments.size(); i >= 2; i -= 2)
        result.insert(result.end(), {arguments[i - 2], arguments[i - 1]});
    return result;
}

} // namespace quoin
