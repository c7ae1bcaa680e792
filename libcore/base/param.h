// A parameter is written once: in the list() of its Params struct, with unit, interval and a sentence. From that list
// come --help, --describe, --set, YAML checks, the reference pages and the cache key.
//
//     enum class Method { Heap, Hybrid };
//     constexpr auto choice_names(Method) { return std::array{"heap", "hybrid"}; }   // in the order of the enumerators
//
//     struct PartitionParams {
//         double max_error = 0.008;
//         Method method = Method::Hybrid;
//
//         static constexpr auto list()
//         {
//             using P = PartitionParams;
//             return std::tuple{
//                 Param{"max_error", &P::max_error, "m", "largest RMS distance of a cluster to its plane", 0.0, 1.0},
//                 Param{"method", &P::method, "", "how clusters grow"},
//             };
//         }
//     };
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <variant>
#include <vector>

namespace quoin {

// neutral: the value that leaves results as they were before the parameter existed; it does not enter the cache key.
struct ParamFlags {
    bool affects_result = true;
    bool has_neutral = false;
};

template <class Owner, class T>
struct Param {
    const char* name;
    T Owner::*member;
    const char* unit; // "m", "px", "deg", "" for a pure number
    const char* doc;
    double min = -std::numeric_limits<double>::infinity();
    double max = std::numeric_limits<double>::infinity();
    ParamFlags flags = {};
};
template <class Owner, class T>
Param(const char*, T Owner::*, const char*, const char*) -> Param<Owner, T>;
template <class Owner, class T>
Param(const char*, T Owner::*, const char*, const char*, double) -> Param<Owner, T>;
template <class Owner, class T>
Param(const char*, T Owner::*, const char*, const char*, double, double) -> Param<Owner, T>;
template <class Owner, class T>
Param(const char*, T Owner::*, const char*, const char*, double, double, ParamFlags) -> Param<Owner, T>;

using ParamValue = std::variant<bool, std::int64_t, double, std::string>;
enum class ParamType { Bool, Int, Float, String, Choice };

// A parameter without its struct: what the command line, YAML and the cache key work on.
struct ParamSpec {
    std::string name;
    ParamType type = ParamType::Float;
    ParamValue default_value; // a choice is its name
    std::string unit;
    std::string doc;
    double min = 0.0;
    double max = 0.0;
    std::vector<std::string> choices;
    ParamFlags flags;
};
using ParamValues = std::map<std::string, ParamValue>;

std::string_view type_name(ParamType type); // bool, int, float, string, choice

// Text to a value of the spec's type. Throws UsageError saying what was expected when it does not parse, is not a
// number or is outside the interval; `where` begins the message (a file:line:column, or "--set").
ParamValue parse_param(const ParamSpec& spec, std::string_view text, std::string_view where);

// Shortest text that parses back to the same value; floats as std::to_chars prints them.
std::string format_param(const ParamValue& value);

// The spec of that name. Throws UsageError naming the nearest right name.
const ParamSpec& find_param(const std::vector<ParamSpec>& specs, std::string_view name, std::string_view where);

// The candidate with the least edit distance to `name`, or "" when none is near.
std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates);

namespace detail {
template <class T>
ParamValue to_value(const T& value)
{
    if constexpr (std::is_enum_v<T>)
        return std::string(choice_names(T{})[static_cast<std::size_t>(value)]);
    else if constexpr (std::is_same_v<T, bool>)
        return value;
    else if constexpr (std::is_integral_v<T>)
        return static_cast<std::int64_t>(value);
    else if constexpr (std::is_floating_point_v<T>)
        return static_cast<double>(value);
    else
        return std::string(value);
}

template <class T>
void from_value(const ParamValue& value, T& out)
{
    if constexpr (std::is_enum_v<T>) {
        const auto names = choice_names(T{});
        for (std::size_t i = 0; i < names.size(); ++i)
            if (std::get<std::string>(value) == names[i]) out = static_cast<T>(i);
    } else if constexpr (std::is_same_v<T, bool>) {
        out = std::get<bool>(value);
    } else if constexpr (std::is_integral_v<T>) {
        out = static_cast<T>(std::get<std::int64_t>(value));
    } else if constexpr (std::is_floating_point_v<T>) {
        out = static_cast<T>(std::get<double>(value));
    } else {
        out = std::get<std::string>(value);
    }
}

template <class T>
constexpr ParamType type_of()
{
    if constexpr (std::is_enum_v<T>)
        return ParamType::Choice;
    else if constexpr (std::is_same_v<T, bool>)
        return ParamType::Bool;
    else if constexpr (std::is_integral_v<T>)
        return ParamType::Int;
    else if constexpr (std::is_floating_point_v<T>)
        return ParamType::Float;
    else
        return ParamType::String;
}
} // namespace detail

template <class Params>
std::vector<ParamSpec> specs_of()
{
    std::vector<ParamSpec> specs;
    const Params defaults;
    const auto add = [&]<class T>(const Param<Params, T>& p) {
        ParamSpec spec{
            p.name, detail::type_of<T>(), detail::to_value(defaults.*p.member), p.unit, p.doc, p.min, p.max, {},
            p.flags};
        if constexpr (std::is_enum_v<T>)
            for (const char* name : choice_names(T{}))
                spec.choices.emplace_back(name);
        specs.push_back(std::move(spec));
    };
    std::apply([&](const auto&... p) { (add(p), ...); }, Params::list());
    return specs;
}

// Params with the given values laid over the defaults; names that the list lacks are ignored (they were refused on
// parsing).
template <class Params>
Params params_from(const ParamValues& values)
{
    Params params;
    const auto assign = [&](const auto& p) {
        if (const auto it = values.find(p.name); it != values.end()) detail::from_value(it->second, params.*p.member);
    };
    std::apply([&](const auto&... p) { (assign(p), ...); }, Params::list());
    return params;
}

} // namespace quoin
