#include "emit/reference.h"

#include <fmt/format.h>

namespace quoin {
namespace {

// Text of a table's cell.
std::string cell(std::string text)
{
    for (std::size_t at = text.find('|'); at != std::string::npos; at = text.find('|', at + 2))
        text.insert(at, "\\");
    return text;
}

std::string ports_table(const char* title, const std::vector<PortDescription>& ports)
{
    if (ports.empty()) return {};
    std::string text = fmt::format("\n## {}\n\n| port | schema | |\n|---|---|---|\n", title);
    for (const auto& port : ports)
        text += fmt::format("| `{}` | {}/{} | {}{} |\n", port.name, port.schema, port.version, cell(port.doc),
                            port.optional ? " (optional)" : "");
    return text;
}

std::string params_table(const std::vector<ParamSpec>& params)
{
    if (params.empty()) return "\nIt has no parameters.\n";
    std::string text = "\n## Parameters\n\n| name | values | default | |\n|---|---|---|---|\n";
    for (const auto& spec : params) {
        const std::string value = format_param(spec.default_value);
        text += fmt::format("| `{}` | {} | {} | {}{} |\n", spec.name, cell(range_text(spec)),
                            value.empty() ? "" : fmt::format("`{}`", value), cell(spec.doc),
                            spec.flags.affects_result ? "" : " (does not change the result)");
    }
    return text;
}

std::string stage_page(const StageDescription& stage)
{
    return fmt::format("# {}\n\n{} (version {}).{}\n", stage.name, stage.summary, stage.impl_version,
                       stage.reads_images ? " It reads the scan's images: `--scan-root`." : "") +
           ports_table("Inputs", stage.inputs) + ports_table("Outputs", stage.outputs) + params_table(stage.params);
}

std::string index_page(const CommandHelp& help)
{
    std::string text =
        "# Reference\n\nWritten by `quoin emit reference` from what the programs say of themselves; a test "
        "holds it to that.\n\n## Stages\n\n| stage | |\n|---|---|\n";
    for (const auto& stage : help.stages)
        text += fmt::format("| [`{0}`]({0}.md) | {1} |\n", stage.name, cell(stage.summary));
    text += "\n## Verbs\n";
    for (const auto& verb : help.verbs) {
        text += fmt::format("\n### quoin {}\n\n{}.\n", verb.name, verb.summary);
        if (!verb.options.empty()) text += "\n| option | |\n|---|---|\n";
        for (const auto& option : verb.options)
            text += fmt::format("| `{}` | {} |\n", option.flags, cell(option.doc));
    }
    return text;
}

} // namespace

std::map<std::string, std::string> reference_pages(const CommandHelp& help)
{
    std::map<std::string, std::string> pages{{"README.md", index_page(help)}};
    for (const auto& stage : help.stages)
        pages[stage.name + ".md"] = stage_page(stage);
    return pages;
}

} // namespace quoin
