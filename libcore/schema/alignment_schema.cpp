#include "scan/alignment.h"

#include "schema/matrices.h"
#include "schema/schema.h"

namespace quoin {

Artifact to_artifact(const Alignment& alignment)
{
    Artifact artifact{"alignment", 1, {}, {}};
    add_transforms(artifact, "camera_from_world", alignment.camera_from_world);
    add_planes(artifact, "plane", alignment.plane);
    artifact.add<float>("gain", {alignment.gain.size(), 3}, alignment.gain);
    artifact.add<float>("bias", {alignment.bias.size(), 3}, alignment.bias);
    if (!alignment.vignetting.k.isZero(0.0f))
        artifact.add<float>("vignetting", {1, 3}, std::vector{alignment.vignetting.k});
    add_camera(artifact, "camera.color", alignment.color);
    add_transform(artifact, "depth_from_color", alignment.depth_from_color);
    std::vector<double> energy;
    for (const auto& row : alignment.energy)
        energy.insert(energy.end(), row.begin(), row.end());
    artifact.add<double>("energy", {alignment.energy.size(), alignment.energy_name.size()}, energy);
    artifact.add_text("energy.name", joined_lines(alignment.energy_name));
    if (alignment.held_out) {
        const HeldOutScores& scores = *alignment.held_out;
        artifact.add<double>("held_out.score", {2}, std::vector{scores.input, scores.optimized});
        artifact.add<std::uint8_t>("held_out.is_input_kept", {1}, std::vector<std::uint8_t>{scores.is_input_kept});
    }
    return artifact;
}

Alignment read_alignment(const std::filesystem::path& path)
{
    const Artifact artifact = read_artifact(path, "alignment", 1);
    const TensorReader reader(artifact, path);
    Alignment alignment;
    alignment.camera_from_world = read_transforms(reader, "camera_from_world");
    for (const auto& pose : alignment.camera_from_world)
        if (!is_rigid(pose.matrix())) reader.refuse("camera_from_world", "holds a pose that is not rigid");
    const std::size_t count = alignment.camera_from_world.size();
    alignment.plane = read_planes(reader, "plane");
    alignment.gain = reader.array<float, Eigen::Vector3f>("gain", {count, 3});
    alignment.bias = reader.array<float, Eigen::Vector3f>("bias", {count, 3});
    if (reader.has("vignetting"))
        alignment.vignetting.k = reader.array<float, Eigen::Vector3f>("vignetting", {1, 3}).front();
    alignment.color = read_camera(reader, "camera.color");
    alignment.depth_from_color = read_transform(reader, "depth_from_color");
    const Tensor& energy = artifact.tensors.contains("energy") ? artifact.tensors.at("energy") : Tensor{};
    if (energy.shape.size() != 2 || energy.type != DType::F64) reader.refuse("energy", "is not a table of F64");
    alignment.energy_name = reader.lines("energy.name", energy.shape[1]);
    const auto* values = reinterpret_cast<const double*>(energy.bytes.data());
    for (std::size_t i = 0; i < energy.shape[0]; ++i, values += energy.shape[1])
        alignment.energy.emplace_back(values, values + energy.shape[1]);
    if (reader.has("held_out.score")) {
        const auto score = reader.array<double, double>("held_out.score", {2});
        const auto is_kept = reader.array<std::uint8_t, std::uint8_t>("held_out.is_input_kept", {1});
        alignment.held_out = {score[0], score[1], is_kept[0] != 0};
    }
    return alignment;
}

} // namespace quoin
