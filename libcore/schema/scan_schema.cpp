#include "scan/scan.h"

#include "schema/matrices.h"
#include "schema/schema.h"

namespace quoin {
namespace {

constexpr int kVersion = 1;

void add_files(Artifact& artifact, const std::string& name, const std::vector<ScanFile>& files)
{
    std::vector<std::string> names;
    std::vector<Sha256> digests;
    for (const auto& file : files) {
        names.push_back(file.name);
        digests.push_back(file.sha256);
    }
    artifact.add_text(name + ".file", joined_lines(names));
    artifact.add<std::uint8_t>(name + ".sha256", {digests.size(), 32}, digests);
}

std::vector<ScanFile> read_files(const TensorReader& reader, const std::string& name, std::size_t count)
{
    const auto names = reader.lines(name + ".file", count);
    const auto digests = reader.array<std::uint8_t, Sha256>(name + ".sha256", {count, 32});
    std::vector<ScanFile> files(count);
    for (std::size_t i = 0; i < count; ++i) {
        if (names[i].starts_with('/'))
            reader.refuse(name + ".file", "'" + names[i] + "' is not relative to the scan root");
        files[i] = {names[i], digests[i]};
    }
    return files;
}

} // namespace

Artifact to_artifact(const Scan& scan)
{
    Artifact artifact{"scan", kVersion, {}, {}};
    std::vector<Rigid> poses;
    std::vector<std::uint8_t> valid;
    std::vector<double> time;
    std::vector<ScanFile> color, depth;
    for (const auto& frame : scan.frames) {
        poses.push_back(frame.camera_from_world);
        valid.push_back(static_cast<std::uint8_t>(frame.use));
        time.push_back(frame.time);
        color.push_back(frame.color);
        depth.push_back(frame.depth);
    }
    add_camera(artifact, "camera.color", scan.color);
    add_camera(artifact, "camera.depth", scan.depth);
    add_transform(artifact, "depth_from_color", scan.depth_from_color);
    add_transforms(artifact, "camera_from_world", poses);
    artifact.add<std::uint8_t>("valid", {valid.size()}, valid);
    artifact.add<double>("time", {time.size()}, time);
    artifact.add<double>("depth_scale", {2}, std::vector<double>{scan.depth_unit, scan.max_depth});
    add_files(artifact, "color", color);
    add_files(artifact, "depth", depth);
    if (!scan.dense_mesh.name.empty()) add_files(artifact, "dense_mesh", {scan.dense_mesh});
    return artifact;
}

Scan read_scan(const std::filesystem::path& path)
{
    const Artifact artifact = read_artifact(path, "scan", kVersion);
    const TensorReader reader(artifact, path);
    Scan scan;
    scan.color = read_camera(reader, "camera.color");
    scan.depth = read_camera(reader, "camera.depth");
    scan.depth_from_color = read_transform(reader, "depth_from_color");
    const auto scale = reader.array<double, double>("depth_scale", {2});
    if (!(scale[0] > 0.0) || !(scale[1] >= 0.0)) reader.refuse("depth_scale", "is not positive");
    scan.depth_unit = scale[0];
    scan.max_depth = scale[1];
    const auto poses = read_transforms(reader, "camera_from_world");
    const std::size_t count = poses.size();
    const auto valid = reader.array<std::uint8_t, std::uint8_t>("valid", {count});
    const auto time = reader.array<double, double>("time", {count});
    const auto color = read_files(reader, "color", count);
    const auto depth = read_files(reader, "depth", count);
    for (std::size_t i = 0; i < count; ++i) {
        if (valid[i] > 2)
            reader.refuse("valid",
                          "entry " + std::to_string(i) + " is " + std::to_string(valid[i]) + ", expected 0, 1 or 2");
        if (valid[i] != 0 && !is_rigid(poses[i].matrix()))
            reader.refuse("camera_from_world", "frame " + std::to_string(i) + " is not a rigid transform");
        scan.frames.push_back({poses[i], static_cast<FrameUse>(valid[i]), time[i], color[i], depth[i]});
    }
    if (reader.has("dense_mesh.file")) scan.dense_mesh = read_files(reader, "dense_mesh", 1)[0];
    return scan;
}

} // namespace quoin
