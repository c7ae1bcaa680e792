#include "mesh/line_matches.h"

#include "schema/schema.h"
#include "schema/tensor_io.h"

namespace quoin {

Artifact to_artifact(const LineMatches& lines)
{
    Artifact artifact{"lines", 1, {}, {}};
    std::vector<Eigen::Vector4f> segments;
    std::vector<std::uint32_t> frames;
    std::vector<std::array<PlaneId, 2>> planes;
    std::vector<std::array<Eigen::Vector3f, 2>> end_points;
    std::vector<float> errors;
    for (const auto& line : lines) {
        segments.push_back(line.segment);
        frames.push_back(line.frame);
        planes.push_back(line.planes);
        end_points.push_back(line.end_points);
        errors.push_back(line.fit_error);
    }
    artifact.add<float>("segment", {lines.size(), 4}, segments);
    artifact.add<std::uint32_t>("frame", {lines.size()}, frames);
    artifact.add<std::uint32_t>("planes", {lines.size(), 2}, planes);
    artifact.add<float>("end_points", {lines.size(), 2, 3}, end_points);
    artifact.add<float>("fit_error", {lines.size()}, errors);
    return artifact;
}

LineMatches read_lines(const std::filesystem::path& path)
{
    const Artifact artifact = read_artifact(path, "lines", 1);
    const TensorReader reader(artifact, path);
    const auto segments = reader.array<float, Eigen::Vector4f>("segment", {kAny, 4});
    const std::size_t count = segments.size();
    const auto frames = reader.array<std::uint32_t, std::uint32_t>("frame", {count});
    const auto planes = reader.array<std::uint32_t, std::array<PlaneId, 2>>("planes", {count, 2});
    const auto end_points = reader.array<float, std::array<Eigen::Vector3f, 2>>("end_points", {count, 2, 3});
    const auto errors = reader.array<float, float>("fit_error", {count});
    LineMatches lines(count);
    for (std::size_t i = 0; i < count; ++i) {
        if (!segments[i].allFinite() || !end_points[i][0].allFinite() || !end_points[i][1].allFinite())
            reader.refuse("segment", "match " + std::to_string(i) + " is not finite");
        lines[i] = {segments[i], frames[i], planes[i], end_points[i], errors[i]};
    }
    return lines;
}

} // namespace quoin
