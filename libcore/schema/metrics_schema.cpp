#include "schema/schema.h"
#include "schema/tensor_io.h"

namespace quoin {

Artifact to_artifact(const Metrics& metrics)
{
    Artifact artifact{"metrics", 1, {}, {}};
    std::vector<std::string> names, units;
    std::vector<double> values;
    std::vector<std::uint8_t> directions;
    for (const auto& metric : metrics) {
        names.push_back(metric.name);
        units.push_back(metric.unit);
        values.push_back(metric.value);
        directions.push_back(static_cast<std::uint8_t>(metric.better));
    }
    artifact.add_text("name", joined_lines(names));
    artifact.add_text("unit", joined_lines(units));
    artifact.add<double>("value", {values.size()}, values);
    artifact.add<std::uint8_t>("direction", {directions.size()}, directions);
    return artifact;
}

Metrics read_metrics(const std::filesystem::path& path)
{
    const Artifact artifact = read_artifact(path, "metrics", 1);
    const TensorReader reader(artifact, path);
    const auto values = reader.array<double, double>("value", {kAny});
    const auto names = reader.lines("name", values.size());
    const auto units = reader.lines("unit", values.size());
    const auto directions = reader.array<std::uint8_t, std::uint8_t>("direction", {values.size()});
    Metrics metrics;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (directions[i] > 2) reader.refuse("direction", "entry " + std::to_string(i) + " is above 2");
        metrics.push_back({names[i], units[i], values[i], static_cast<Better>(directions[i])});
    }
    return metrics;
}

} // namespace quoin
