#include "base/error.h"
#include "pipeline/catalogue.h"
#include "pipeline/locate.h"
#include "pipeline/source.h"
#include "quoin/option_parser.h"

#include <cmath>
#include <fmt/format.h>

namespace quoin {
namespace {

std::string interval_text(const ParamSpec& spec)
{
    if (!spec.choices.empty()) return fmt::format("{}", fmt::join(spec.choices, " | "));
    const std::string unit = spec.unit.empty() ? "" : " " + spec.unit;
    const bool has_bound = std::isfinite(spec.min) || std::isfinite(spec.max);
    const std::string low = std::isfinite(spec.min) ? fmt::format("{}", spec.min) : "";
    const std::string high = std::isfinite(spec.max) ? fmt::format("{}", spec.max) : "";
    return fmt::format("{}{}{}", type_name(spec.type), has_bound ? fmt::format(" {}..{}", low, high) : "", unit);
}

void print_ports(const char* title, const std::vector<PortDescription>& ports)
{
    fmt::print("\n{}\n", title);
    for (const auto& port : ports)
        fmt::print("  {:<16} {:<18} {}{}\n", port.name, fmt::format("{}/{}", port.schema, port.version), port.doc,
                   port.optional ? " (optional)" : "");
}

void print_stage(const StageDescription& stage)
{
    fmt::print("{} (version {}): {}\n", stage.name, stage.impl_version, stage.summary);
    print_ports("inputs", stage.inputs);
    print_ports("outputs", stage.outputs);
    fmt::print("\nparameters\n");
    for (const auto& spec : stage.params)
        fmt::print("  {:<26} {} (default {})\n      {}\n", spec.name, interval_text(spec),
                   format_param(spec.default_value), spec.doc);
}

} // namespace

int describe_verb(const Arguments& arguments)
{
    OptionParser parser("shows ports and parameters of a stage; `STAGE --describe` gives the same as JSON",
                        "quoin describe");
    std::string name;
    parser.option("STAGE", name, "a stage, or the path of a program").required();
    if (!parser.parse(arguments)) return 0;
    Catalogue catalogue(stage_folder());
    const std::filesystem::path program = catalogue.locate(name, std::filesystem::current_path());
    if (!names_a_path(name) && !std::filesystem::exists(program))
        throw UsageError(fmt::format("there is no stage '{}'{}", name, hint(name, catalogue.names())));
    print_stage(catalogue.describe(program).description);
    return 0;
}

} // namespace quoin
