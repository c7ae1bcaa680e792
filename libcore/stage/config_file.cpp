#include "base/error.h"
#include "stage/command_line.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

namespace quoin {
namespace {

std::string place(const std::filesystem::path& path, const YAML::Mark& mark)
{
    return fmt::format("{}:{}:{}", path.string(), mark.line + 1, mark.column + 1);
}

YAML::Node load(const std::filesystem::path& path)
{
    try {
        return YAML::LoadFile(path.string());
    } catch (const YAML::BadFile&) {
        throw UsageError(fmt::format("--config {}: cannot read the file", path.string()));
    } catch (const YAML::ParserException& error) {
        throw UsageError(fmt::format("{}: {}", place(path, error.mark), error.msg));
    }
}

} // namespace

ParamValues read_config(const std::filesystem::path& path, const std::vector<ParamSpec>& params)
{
    const YAML::Node root = load(path);
    ParamValues values;
    if (root.IsNull()) return values;
    if (!root.IsMap()) throw UsageError(fmt::format("{}: expected 'name: value' lines", place(path, root.Mark())));
    for (const auto& entry : root) {
        const std::string where = place(path, entry.first.Mark());
        const auto name = entry.first.as<std::string>();
        if (!entry.second.IsScalar())
            throw UsageError(fmt::format("{}: parameter '{}' must be one value", where, name));
        const ParamSpec& spec = find_param(params, name, where);
        if (!values.emplace(name, parse_param(spec, entry.second.Scalar(), place(path, entry.second.Mark()))).second)
            throw UsageError(fmt::format("{}: parameter '{}' is given twice", where, name));
    }
    return values;
}

} // namespace quoin
