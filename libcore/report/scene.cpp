#include "mesh/plane_color.h"
#include "report/coarsen.h"
#include "report/page_data.h"

#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace quoin {
namespace {

using Json = nlohmann::ordered_json;
using Eigen::Vector3d;
using Eigen::Vector3f;

Json numbers(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

std::vector<Vector3f> moved(const std::vector<Vector3f>& points, const Rigid& to_from)
{
    std::vector<Vector3f> result;
    result.reserve(points.size());
    for (const auto& p : points)
        result.push_back((to_from * p.cast<double>()).cast<float>());
    return result;
}

Json bounds_of(const TriangleMesh& mesh, const std::vector<Vector3f>& position)
{
    Eigen::AlignedBox3d box;
    for (const auto& face : mesh.face)
        for (const VertexId v : face)
            box.extend(position[v].cast<double>());
    return {{"min", numbers(box.min())}, {"max", numbers(box.max())}};
}

void add_model(const PlaneMesh& model, const Rigid& model_from_world, Json& data, PageArrays& arrays)
{
    const auto position = moved(model.mesh.position, model_from_world);
    data["bounds"] = bounds_of(model.mesh, position);
    arrays.add("model-position", "f32", position);
    arrays.add("model-face", "u32", model.mesh.face);
    arrays.add("model-face-plane", "u32", model.face_plane);
    Json equations = Json::array(), colors = Json::array();
    for (PlaneId p = 0; p < model.plane.size(); ++p) {
        const Vector3d normal = model_from_world.linear() * model.plane[p].normal;
        equations.push_back(
            {normal.x(), normal.y(), normal.z(), model.plane[p].offset - normal.dot(model_from_world.translation())});
        colors.push_back(plane_color(p));
    }
    data["planes"] = {{"equation", equations}, {"color", colors}};
}

void add_texture(const TexturedMesh& textured, Json& data, PageArrays& arrays)
{
    arrays.add("model-uv", "f32", textured.uv);
    arrays.add("model-corner-uv", "u32", textured.corner_uv);
    arrays.add("model-face-page", "u32", textured.face_page);
    data["pages"] = Json::array();
    for (std::size_t i = 0; i < textured.page.size(); ++i) {
        const AtlasPage& page = textured.page[i];
        const bool is_jpeg = !page.image.empty() && page.image[0] == std::byte{0xff};
        const std::string mime = is_jpeg ? "image/jpeg" : "image/png";
        arrays.add_image(fmt::format("page-{}-color", i), mime, page.image);
        arrays.add_image(fmt::format("page-{}-source", i), "image/png", page.source);
        data["pages"].push_back({{"width", page.width}, {"height", page.height}, {"mime", mime}});
    }
}

// Positions as multiples of the smallest step that 16 bits reach with: a fraction of a millimetre in a room.
void add_dense(const TriangleMesh& dense, const Rigid& model_from_world, Json& data, PageArrays& arrays)
{
    constexpr float kLast = 65535.0f;
    const auto position = moved(dense.position, model_from_world);
    Eigen::AlignedBox3f box;
    for (const auto& p : position)
        box.extend(p);
    const float step = std::max(box.sizes().maxCoeff() / kLast, 1e-6f);
    std::vector<std::array<std::uint16_t, 3>> steps(position.size());
    for (std::size_t v = 0; v < position.size(); ++v)
        for (int c = 0; c < 3; ++c)
            steps[v][static_cast<std::size_t>(c)] =
                static_cast<std::uint16_t>(std::lround(std::min((position[v][c] - box.min()[c]) / step, kLast)));
    arrays.add("dense-position", "u16", steps);
    arrays.add("dense-face", "u32", dense.face);
    if (!dense.color.empty()) arrays.add("dense-color", "u8", dense.color);
    data["dense"] = {{"min", numbers(box.min().cast<double>())}, {"step", step}};
}

void add_lines(const LineMatches& lines, const Rigid& model_from_world, PageArrays& arrays)
{
    std::vector<Vector3f> ends;
    for (const LineMatch& line : lines)
        ends.insert(ends.end(), line.end_points.begin(), line.end_points.end());
    arrays.add("lines", "f32", moved(ends, model_from_world));
}

void add_cameras(const ReportParts& parts, Json& data)
{
    const Keyframes& keyframes = *parts.keyframes;
    const Camera& color = parts.alignment ? parts.alignment->color : parts.scan->color;
    data["camera"] = {{"fx", color.fx}, {"fy", color.fy}, {"width", color.width}, {"height", color.height}};
    data["cameras"] = Json::array();
    for (std::size_t k = 0; k < keyframes.frame.size(); ++k) {
        const FrameId id = keyframes.frame[k];
        const Rigid before = parts.model_from_world * parts.scan->color_from_world(id).inverse();
        const Rigid after =
            parts.alignment ? parts.model_from_world * parts.alignment->color_from_world(k).inverse() : before;
        Json camera{{"frame", id},
                    {"position", numbers(after.translation())},
                    {"right", numbers(after.linear().col(0))},
                    {"down", numbers(after.linear().col(1))},
                    {"forward", numbers(after.linear().col(2))}};
        if (parts.alignment) camera["before"] = numbers(before.translation());
        data["cameras"].push_back(std::move(camera));
    }
}

} // namespace

void add_scene(const ReportParts& parts, const ReportLimits& limits, Json& data, PageArrays& arrays)
{
    add_model(*parts.model(), parts.model_from_world, data, arrays);
    if (!parts.face_filled.empty()) arrays.add("model-face-filled", "u8", parts.face_filled);
    if (parts.textured) add_texture(*parts.textured, data, arrays);
    if (parts.dense && !parts.dense->face.empty())
        add_dense(coarsen(*parts.dense, limits.dense_faces), parts.model_from_world, data, arrays);
    if (parts.lines) add_lines(*parts.lines, parts.model_from_world, arrays);
    if (parts.scan && parts.keyframes) add_cameras(parts, data);
}

} // namespace quoin
