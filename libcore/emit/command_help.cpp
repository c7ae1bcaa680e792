#include "emit/command_help.h"

#include <cmath>
#include <fmt/format.h>
#include <sstream>

namespace quoin {

VerbHelp parse_verb_help(const std::string& name, const std::string& text)
{
    VerbHelp help{name, "", {}};
    std::istringstream lines(text);
    std::getline(lines, help.summary);
    for (std::string line; std::getline(lines, line);)
        if (const std::size_t tab = line.find('\t'); tab != std::string::npos)
            help.options.push_back({line.substr(0, tab), line.substr(tab + 1)});
    return help;
}

std::string range_text(const ParamSpec& spec)
{
    if (!spec.choices.empty()) return fmt::format("{}", fmt::join(spec.choices, ", "));
    std::string text{type_name(spec.type)};
    if (std::isfinite(spec.min) && std::isfinite(spec.max))
        text += fmt::format(", {} to {}", format_param(spec.min), format_param(spec.max));
    else if (std::isfinite(spec.min))
        text += fmt::format(", at least {}", format_param(spec.min));
    else if (std::isfinite(spec.max))
        text += fmt::format(", at most {}", format_param(spec.max));
    return spec.unit.empty() ? text : fmt::format("{} [{}]", text, spec.unit);
}

} // namespace quoin
