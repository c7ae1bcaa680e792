#include "mesh/ground_truth.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "mesh/ply.h"

#include <cstring>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sstream>

namespace quoin {
namespace {

using nlohmann::ordered_json;

ordered_json to_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

std::string planes_text(const std::vector<TruePlane>& planes)
{
    ordered_json list = ordered_json::array();
    for (std::size_t i = 0; i < planes.size(); ++i)
        list.push_back({{"id", i},
                        {"name", planes[i].name},
                        {"normal", to_json(planes[i].plane.normal)},
                        {"offset", planes[i].plane.offset},
                        {"area", planes[i].area}});
    return ordered_json{{"planes", list}}.dump(1) + "\n";
}

std::string creases_text(const std::vector<TrueCrease>& creases)
{
    ordered_json list = ordered_json::array();
    for (const TrueCrease& c : creases)
        list.push_back({{"from", to_json(c.ends[0])},
                        {"to", to_json(c.ends[1])},
                        {"planes", {c.planes[0], c.planes[1]}},
                        {"angle", c.angle},
                        {"concave", c.concave},
                        {"observed", c.observed}});
    return ordered_json{{"creases", list}}.dump(1) + "\n";
}

std::string trajectory_text(const GroundTruth& truth)
{
    std::string text = "# time tx ty tz qx qy qz qw, camera to world\n";
    for (std::size_t i = 0; i < truth.world_from_camera.size(); ++i) {
        const Eigen::Vector3d t = truth.world_from_camera[i].translation();
        const Eigen::Quaterniond q(truth.world_from_camera[i].linear());
        text += fmt::format("{:.6f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", truth.time[i], t.x(), t.y(),
                            t.z(), q.x(), q.y(), q.z(), q.w());
    }
    return text;
}

std::string exposures_text(const std::vector<TrueExposure>& exposures)
{
    std::string text = "# gain r g b, bias r g b: observed = gain * true + bias, of 255\n";
    for (const TrueExposure& e : exposures)
        text += fmt::format("{:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", e.gain.x(), e.gain.y(), e.gain.z(),
                            e.bias.x(), e.bias.y(), e.bias.z());
    return text;
}

// The rows of samples.ply, as its header declares them.
#pragma pack(push, 1)
struct SampleRow {
    std::array<float, 3> position, normal;
    std::array<std::uint8_t, 3> color;
    std::int32_t plane;
    std::int32_t views;
};
#pragma pack(pop)

std::string samples_header(std::size_t count)
{
    return fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n"
                       "property float x\nproperty float y\nproperty float z\n"
                       "property float nx\nproperty float ny\nproperty float nz\n"
                       "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                       "property int plane\nproperty int views\nend_header\n",
                       count);
}

std::string samples_bytes(const std::vector<TrueSample>& samples)
{
    std::string bytes = samples_header(samples.size());
    for (const TrueSample& s : samples) {
        const SampleRow row{{s.position.x(), s.position.y(), s.position.z()},
                            {s.normal.x(), s.normal.y(), s.normal.z()},
                            s.color,
                            static_cast<std::int32_t>(s.plane),
                            static_cast<std::int32_t>(s.views)};
        bytes.append(reinterpret_cast<const char*>(&row), sizeof row);
    }
    return bytes;
}

std::vector<TrueSample> parse_samples(const std::filesystem::path& path)
{
    const std::string bytes = read_text(path);
    constexpr std::string_view element = "element vertex ";
    const std::size_t at = bytes.find(element);
    const std::size_t count =
        at == std::string::npos ? 0 : std::strtoull(bytes.c_str() + at + element.size(), nullptr, 10);
    const std::string header = samples_header(count);
    if (!bytes.starts_with(header) || (bytes.size() - header.size()) / sizeof(SampleRow) != count ||
        (bytes.size() - header.size()) % sizeof(SampleRow) != 0)
        throw InputError(path.string() +
                         ": not a file of ground-truth samples as synthesize writes it; make the scan again");
    std::vector<TrueSample> samples(count);
    for (std::size_t i = 0; i < count; ++i) {
        SampleRow row;
        std::memcpy(&row, bytes.data() + header.size() + i * sizeof row, sizeof row);
        samples[i] = {Eigen::Vector3f(row.position.data()), Eigen::Vector3f(row.normal.data()), row.color,
                      static_cast<PlaneId>(row.plane), static_cast<std::uint32_t>(row.views)};
    }
    return samples;
}

Eigen::Vector3d vector_of(const ordered_json& json)
{
    return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

// Reads a JSON list, turning the parser's complaints into ours.
template <class Read>
void read_list(const std::filesystem::path& path, const char* key, const Read& read)
{
    try {
        const ordered_json file = ordered_json::parse(read_text(path));
        for (const ordered_json& item : file.at(key))
            read(item);
    } catch (const nlohmann::json::exception& error) {
        throw InputError(
            fmt::format("{}: expected an object with the list '{}' ({})", path.string(), key, error.what()));
    }
}

// Rows of `columns` numbers; lines that begin with # are skipped.
std::vector<std::vector<double>> read_table(const std::filesystem::path& path, std::size_t columns)
{
    std::istringstream lines(read_text(path));
    std::vector<std::vector<double>> rows;
    std::size_t number = 0;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        if (line.empty() || line[0] == '#') continue;
        std::istringstream cells(line);
        std::vector<double> row;
        for (double value = 0.0; cells >> value;)
            row.push_back(value);
        if (row.size() != columns)
            throw InputError(
                fmt::format("{}:{}: expected {} numbers, found {}", path.string(), number, columns, row.size()));
        rows.push_back(std::move(row));
    }
    return rows;
}

} // namespace

void write_ground_truth(const std::filesystem::path& folder, const GroundTruth& truth)
{
    write_ply(folder / "mesh.ply", truth.mesh, {{}, truth.face_plane});
    write_atomically(folder / "planes.json", planes_text(truth.plane));
    write_atomically(folder / "creases.json", creases_text(truth.crease));
    write_atomically(folder / "trajectory.txt", trajectory_text(truth));
    write_atomically(folder / "exposures.txt", exposures_text(truth.exposure));
    write_atomically(folder / "samples.ply", samples_bytes(truth.sample));
}

GroundTruth read_ground_truth(const std::filesystem::path& folder)
{
    GroundTruth truth;
    truth.mesh = read_ply(folder / "mesh.ply");
    read_list(folder / "planes.json", "planes", [&](const ordered_json& p) {
        truth.plane.push_back({p.at("name").get<std::string>(),
                               {vector_of(p.at("normal")), p.at("offset").get<double>()},
                               p.at("area").get<double>()});
    });
    read_list(folder / "creases.json", "creases", [&](const ordered_json& c) {
        truth.crease.push_back({{vector_of(c.at("from")), vector_of(c.at("to"))},
                                c.at("planes").get<std::array<PlaneId, 2>>(),
                                c.at("angle").get<double>(),
                                c.at("concave").get<bool>(),
                                c.at("observed").get<bool>()});
    });
    for (const auto& row : read_table(folder / "trajectory.txt", 8)) {
        Rigid pose = Rigid::Identity();
        pose.linear() = Eigen::Quaterniond(row[7], row[4], row[5], row[6]).normalized().toRotationMatrix();
        pose.translation() = Eigen::Vector3d(row[1], row[2], row[3]);
        truth.time.push_back(row[0]);
        truth.world_from_camera.push_back(pose);
    }
    for (const auto& row : read_table(folder / "exposures.txt", 6))
        truth.exposure.push_back({{row[0], row[1], row[2]}, {row[3], row[4], row[5]}});
    truth.sample = parse_samples(folder / "samples.ply");
    return truth;
}

std::optional<GroundTruth> find_ground_truth(const std::filesystem::path& scan_folder)
{
    const std::filesystem::path folder = scan_folder / "ground_truth";
    if (!std::filesystem::is_directory(folder)) return std::nullopt;
    return read_ground_truth(folder);
}

} // namespace quoin
