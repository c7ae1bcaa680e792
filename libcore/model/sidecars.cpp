#include "model/writers.h"

#include "base/atomic_file.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <numbers>

namespace quoin {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kLevelOrUpright = 25.0 * std::numbers::pi / 180.0; // [rad]

std::string orientation(const Eigen::Vector3d& normal)
{
    if (normal.y() >= std::cos(kLevelOrUpright)) return "up";
    if (normal.y() <= -std::cos(kLevelOrUpright)) return "down";
    return std::abs(normal.y()) <= std::sin(kLevelOrUpright) ? "upright" : "sloped";
}

Json vector(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Json matrix(const Rigid& transform)
{
    Json rows = Json::array();
    for (int r = 0; r < 4; ++r) {
        Json row = Json::array();
        for (int c = 0; c < 4; ++c)
            row.push_back(transform.matrix()(r, c));
        rows.push_back(row);
    }
    return rows;
}

Json frame(const Model& model)
{
    return {{"units", "m"},
            {"up", "+y"},
            {"levelled", model.levelled},
            {"model_from_world", matrix(model.model_from_world)}};
}

void write_json(const Json& json, const fs::path& path)
{
    constexpr int kIndent = 2;
    write_atomically(path, std::string_view(json.dump(kIndent) + "\n"));
}

double total_area(const TriangleMesh& mesh)
{
    double area = 0.0;
    for (FaceId f = 0; f < mesh.face.size(); ++f)
        area += face_area(mesh, f);
    return area;
}

Json files_in(const fs::path& folder)
{
    std::vector<fs::directory_entry> entries(fs::directory_iterator(folder), fs::directory_iterator{});
    std::ranges::sort(entries);
    Json files = Json::object();
    for (const auto& entry : entries)
        if (entry.is_regular_file()) files[entry.path().filename().string()] = entry.file_size();
    return files;
}

} // namespace

void write_planes(const Model& model, const fs::path& path)
{
    std::vector<double> area(model.plane.size(), 0.0);
    std::vector<std::size_t> faces(model.plane.size(), 0);
    for (FaceId f = 0; f < model.face_plane.size(); ++f) {
        area[model.face_plane[f]] += face_area(model.mesh, f);
        ++faces[model.face_plane[f]];
    }
    Json planes = Json::array();
    for (PlaneId p = 0; p < model.plane.size(); ++p)
        planes.push_back({{"id", p},
                          {"normal", vector(model.plane[p].normal)},
                          {"offset", model.plane[p].offset},
                          {"area", area[p]},
                          {"faces", faces[p]},
                          {"orientation", orientation(model.plane[p].normal)},
                          {"floor", model.floor == p},
                          {"color", model.plane_color[p]}});
    write_json({{"equation", "normal . x + offset = 0"}, {"frame", frame(model)}, {"planes", planes}}, path);
}

void write_trajectory(const Model& model, const fs::path& path)
{
    std::string text = "# time tx ty tz qx qy qz qw, camera to model, +z forward, +y down in the camera\n";
    for (const auto& pose : model.trajectory) {
        const Eigen::Vector3d t = pose.model_from_camera.translation();
        const Eigen::Quaterniond q(pose.model_from_camera.linear());
        text += fmt::format("{:.6f} {:.7f} {:.7f} {:.7f} {:.9f} {:.9f} {:.9f} {:.9f}\n", pose.time, t.x(), t.y(), t.z(),
                            q.x(), q.y(), q.z(), q.w());
    }
    write_atomically(path, std::string_view(text));
}

void write_summary(const Model& model, const fs::path& folder, const fs::path& path)
{
    Eigen::AlignedBox3d box;
    for (const auto& face : model.mesh.face)
        for (const auto v : face)
            box.extend(model.mesh.position[v].cast<double>());
    Json pages = Json::array();
    for (const auto& page : model.page)
        pages.push_back({{"file", page.file}, {"width", page.page->width}, {"height", page.page->height}});
    Json summary{{"generator", model.generator}, {"frame", frame(model)}};
    summary["frame"]["floor_plane"] = model.floor ? Json(*model.floor) : Json();
    summary["counts"] = {{"vertices", model.mesh.position.size()},
                         {"faces", model.mesh.face.size()},
                         {"planes", model.plane.size()},
                         {"pages", model.page.size()},
                         {"cameras", model.trajectory.size()}};
    summary["area"] = total_area(model.mesh);
    summary["bounds"] = {{"min", vector(box.min())}, {"max", vector(box.max())}};
    summary["pages"] = pages;
    summary["files"] = files_in(folder);
    write_json(summary, path);
}

} // namespace quoin
