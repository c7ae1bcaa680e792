#include "stage/command_line.h"

#include "base/error.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>

namespace quoin {
namespace {

namespace fs = std::filesystem;

// The arguments as they are written, before any is checked.
struct Raw {
    std::vector<std::string> in, out, set;
    std::string config, memory = "0", cache = "auto", progress = "auto", log_level = "info";
};

template <class Enum>
Enum parse_choice(const std::string& flag, const std::string& text, const std::vector<std::string>& names)
{
    const auto it = std::ranges::find(names, text);
    if (it == names.end())
        throw UsageError(fmt::format("{} is '{}': expected one of {}", flag, text, fmt::join(names, ", ")));
    return static_cast<Enum>(it - names.begin());
}

std::pair<std::string, std::string> split(const std::string& flag, const std::string& text)
{
    const auto at = text.find('=');
    if (at == std::string::npos || at == 0) throw UsageError(fmt::format("{} {}: expected NAME=VALUE", flag, text));
    return {text.substr(0, at), text.substr(at + 1)};
}

std::map<std::string, fs::path> parse_ports(const std::string& flag, const std::vector<std::string>& arguments,
                                            const std::vector<Port>& ports)
{
    std::map<std::string, fs::path> paths;
    std::vector<std::string> names;
    for (const auto& port : ports)
        names.push_back(port.name);
    for (const auto& argument : arguments) {
        const auto [name, path] = split(flag, argument);
        if (std::ranges::find(names, name) == names.end()) {
            const std::string near = nearest_name(name, names);
            throw UsageError(fmt::format("{} {}: no port '{}'{}", flag, argument, name,
                                         near.empty() ? fmt::format("; there is: {}", fmt::join(names, ", "))
                                                      : fmt::format("; did you mean '{}'?", near)));
        }
        if (path.empty()) throw UsageError(fmt::format("{} {}: the path is empty", flag, argument));
        if (!paths.emplace(name, path).second)
            throw UsageError(fmt::format("{} {}: port '{}' is given twice", flag, argument, name));
    }
    return paths;
}

void require_ports(const Stage& stage, const CommandLine& line)
{
    for (const auto& port : stage.inputs)
        if (!port.optional && !line.inputs.contains(port.name))
            throw UsageError(fmt::format("{}: input '{}' is missing: add --in {}=PATH ({})", stage.name, port.name,
                                         port.name, port.doc));
    if (line.outputs.empty() && !line.key)
        throw UsageError(fmt::format("{}: no output: add --out {}=PATH", stage.name, stage.outputs.front().name));
    if (stage.reads_images && line.scan_root.empty() && line.inputs.contains("scan") && !line.key)
        throw UsageError(
            fmt::format("{}: --scan-root is missing: name the folder that the scan's images are in", stage.name));
}

ParamValues merged_params(const Raw& raw, const std::vector<ParamSpec>& specs)
{
    ParamValues values;
    for (const auto& spec : specs)
        values[spec.name] = spec.default_value;
    if (!raw.config.empty())
        for (auto& [name, value] : read_config(raw.config, specs))
            values[name] = value;
    for (const auto& argument : raw.set) {
        const auto [name, text] = split("--set", argument);
        values[name] = parse_param(find_param(specs, name, "--set"), text, "--set");
    }
    return values;
}

void parse_raw(CLI::App& app, CommandLine& line, Raw& raw)
{
    app.set_help_flag();
    app.add_flag("-h,--help", line.help);
    app.add_flag("--describe", line.describe);
    app.add_flag("--key", line.key);
    const auto repeated = [&](const char* flag, std::vector<std::string>& values) {
        app.add_option(flag, values)
            ->expected(1)
            ->allow_extra_args(false)
            ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    };
    repeated("--in", raw.in);
    repeated("--out", raw.out);
    repeated("--set", raw.set);
    app.add_option("--config", raw.config);
    app.add_option("--scan-root", line.scan_root);
    app.add_option("--threads", line.threads)->check(CLI::Range(0, 4096));
    app.add_option("--memory", raw.memory);
    app.add_option("--progress", raw.progress);
    app.add_option("--log-level", raw.log_level);
    app.add_option("--cache", raw.cache);
    app.add_option("--store", line.store);
    app.add_option("--record", line.record);
}

} // namespace

std::uint64_t parse_size(std::string_view text)
{
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const std::string_view unit(end, static_cast<std::size_t>(text.data() + text.size() - end));
    const std::string_view units = "KMGT";
    const auto power = unit.empty() ? 0 : units.find(unit[0]) + 1;
    const bool known = unit.empty() || (power >= 1 && power <= 4 &&
                                        (unit.size() == 1 || unit.substr(1) == "iB" || unit.substr(1) == "B"));
    if (error != std::errc() || !known || !(value >= 0.0))
        throw UsageError(fmt::format("--memory is '{}': expected a size such as 4G or 500M", text));
    return static_cast<std::uint64_t>(value * std::pow(1024.0, static_cast<double>(power)));
}

CommandLine parse_command_line(const Stage& stage, const std::vector<ParamSpec>& params, int argc, char** argv)
{
    CommandLine line;
    Raw raw;
    CLI::App app(stage.summary, stage.name);
    parse_raw(app, line, raw);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        throw UsageError(fmt::format("{}: {}; see --help", stage.name, error.what()));
    }
    if (line.help || line.describe) return line;
    line.inputs = parse_ports("--in", raw.in, stage.inputs);
    line.outputs = parse_ports("--out", raw.out, stage.outputs);
    line.params = merged_params(raw, params);
    line.memory = parse_size(raw.memory);
    line.cache = parse_choice<CacheMode>("--cache", raw.cache, {"auto", "off", "only"});
    line.progress = parse_choice<ProgressMode>("--progress", raw.progress, {"auto", "bar", "json", "none"});
    line.log_level = parse_log_level(raw.log_level);
    if (const char* store = std::getenv("QUOIN_STORE"); line.store.empty() && store != nullptr) line.store = store;
    if (line.store.empty() && line.cache == CacheMode::Only)
        throw UsageError("--cache only: no store: add --store DIR or set $QUOIN_STORE");
    if (line.store.empty()) line.cache = CacheMode::Off;
    require_ports(stage, line);
    return line;
}

} // namespace quoin
