#include "mesh/ply.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/log.h"
#include "mesh/ply_stream.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <optional>

static_assert(std::endian::native == std::endian::little, "binary files are written from memory");

namespace quoin {
namespace {

using ply::Body;
using ply::Element;
using ply::Property;
using ply::Type;

// What a vertex property is for; `slot` is 0..2 for x, y, z or red, green, blue.
enum class Role : std::uint8_t { None, Position, Normal, Color };
struct Target {
    Role role = Role::None;
    int slot = 0;
};

Target target_of(const Property& property)
{
    struct Names {
        Role role;
        std::array<std::string_view, 3> names;
    };
    constexpr std::array<Names, 5> kKnown{{{Role::Position, {"x", "y", "z"}},
                                           {Role::Normal, {"nx", "ny", "nz"}},
                                           {Role::Color, {"red", "green", "blue"}},
                                           {Role::Color, {"r", "g", "b"}},
                                           {Role::Color, {"diffuse_red", "diffuse_green", "diffuse_blue"}}}};
    if (property.count_type) return {};
    for (const auto& known : kKnown)
        for (int slot = 0; slot < 3; ++slot)
            if (property.name == known.names[static_cast<std::size_t>(slot)]) return {known.role, slot};
    return {};
}

// 8-bit colour of a channel: fractions of one are scaled, 16-bit values keep their upper half.
std::uint8_t channel_of(double value, Type type)
{
    const bool fraction = type == Type::F32 || type == Type::F64;
    const double scaled = fraction ? value * 255.0 : size_of(type) == 2 ? value / 257.0 : value;
    return static_cast<std::uint8_t>(std::lround(std::isnan(scaled) ? 0.0 : std::clamp(scaled, 0.0, 255.0)));
}

std::array<int, 4> channels_per_role(const std::vector<Target>& targets)
{
    std::array<int, 4> channels{};
    for (const auto& target : targets)
        channels[static_cast<std::size_t>(target.role)] |= 1 << target.slot;
    return channels;
}

void read_vertices(const Element& element, Body& body, TriangleMesh& mesh)
{
    constexpr int kAllThree = 7;
    std::vector<Target> targets;
    for (const auto& property : element.properties)
        targets.push_back(target_of(property));
    const auto channels = channels_per_role(targets);
    const auto has = [&](Role role) { return channels[static_cast<std::size_t>(role)] == kAllThree; };
    if (!has(Role::Position)) body.fail("the header names no properties x, y and z");
    mesh.position.resize(element.count);
    if (has(Role::Normal)) mesh.normal.resize(element.count);
    if (has(Role::Color)) mesh.color.resize(element.count);
    for (std::size_t v = 0; v < element.count; ++v, body.next_row()) {
        for (std::size_t i = 0; i < targets.size(); ++i) {
            const auto& property = element.properties[i];
            const auto [role, slot] = targets[i];
            if (role == Role::None || !has(role))
                body.skip(property);
            else if (role == Role::Position)
                mesh.position[v][slot] = static_cast<float>(body.number(property.type));
            else if (role == Role::Normal)
                mesh.normal[v][slot] = static_cast<float>(body.number(property.type));
            else
                mesh.color[v][static_cast<std::size_t>(slot)] = channel_of(body.number(property.type), property.type);
        }
    }
}

struct Polygons {
    std::vector<VertexId> corner;         // of all faces, one after the other
    std::vector<std::size_t> first = {0}; // F + 1
};

Polygons read_faces(const Element& element, Body& body)
{
    const auto is_corners = [](const Property& p) {
        return p.count_type && (p.name == "vertex_indices" || p.name == "vertex_index");
    };
    if (std::none_of(element.properties.begin(), element.properties.end(), is_corners))
        body.fail("the header names no list vertex_indices");
    Polygons polygons;
    polygons.first.reserve(element.count + 1);
    polygons.corner.reserve(3 * element.count);
    for (std::size_t f = 0; f < element.count; ++f, body.next_row()) {
        for (const auto& property : element.properties) {
            if (!is_corners(property)) {
                body.skip(property);
                continue;
            }
            for (std::size_t size = body.list_size(property); size > 0; --size) {
                const double index = body.number(property.type);
                if (!(index >= 0.0 && index < 4294967295.0))
                    body.fail(fmt::format("vertex index {} is out of range", index));
                polygons.corner.push_back(static_cast<VertexId>(index));
            }
        }
        polygons.first.push_back(polygons.corner.size());
    }
    return polygons;
}

void triangulate(std::span<const VertexId> corners, TriangleMesh& mesh)
{
    const auto squared_length = [&](std::size_t i, std::size_t j) {
        return (mesh.position[corners[i]] - mesh.position[corners[j]]).squaredNorm();
    };
    // A fan around corner 1 cuts a quad along its other diagonal.
    const std::size_t apex = corners.size() == 4 && squared_length(1, 3) < squared_length(0, 2) ? 1 : 0;
    const auto at = [&](std::size_t i) { return corners[(apex + i) % corners.size()]; };
    for (std::size_t i = 1; i + 1 < corners.size(); ++i)
        mesh.face.push_back({at(0), at(i), at(i + 1)});
}

void add_polygons(const Polygons& polygons, const std::string& name, TriangleMesh& mesh)
{
    std::size_t skipped = 0;
    mesh.face.reserve(polygons.corner.size() / 3);
    for (std::size_t f = 0; f + 1 < polygons.first.size(); ++f) {
        const std::span corners(polygons.corner.data() + polygons.first[f], polygons.first[f + 1] - polygons.first[f]);
        for (const VertexId v : corners)
            if (v >= mesh.position.size())
                throw InputError(fmt::format("{}: face {} names vertex {}, but there are {} vertices", name, f, v,
                                             mesh.position.size()));
        if (corners.size() < 3)
            ++skipped;
        else
            triangulate(corners, mesh);
    }
    if (skipped > 0) log_warning(fmt::format("{}: {} faces of fewer than three corners are skipped.", name, skipped));
}

template <class T>
void append(std::vector<std::byte>& bytes, const T& value)
{
    const auto raw = std::as_bytes(std::span(&value, 1));
    bytes.insert(bytes.end(), raw.begin(), raw.end());
}

std::string header_of(const TriangleMesh& mesh, const PlyFaceData& faces)
{
    constexpr const char* kColor = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    std::string text = "ply\nformat binary_little_endian 1.0\n";
    text +=
        fmt::format("element vertex {}\nproperty float x\nproperty float y\nproperty float z\n", mesh.position.size());
    if (!mesh.normal.empty()) text += "property float nx\nproperty float ny\nproperty float nz\n";
    if (!mesh.color.empty()) text += kColor;
    text += fmt::format("element face {}\nproperty list uchar int vertex_indices\n", mesh.face.size());
    if (!faces.color.empty()) text += kColor;
    if (!faces.plane.empty()) text += "property int plane\n";
    return text + "end_header\n";
}

} // namespace

TriangleMesh parse_ply(std::span<const std::byte> bytes, const std::string& name)
{
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const ply::Header header = ply::parse_header(text, name);
    Body body(text.substr(header.size), header.encoding, name);
    TriangleMesh mesh;
    std::optional<Polygons> polygons;
    for (const auto& element : header.elements) {
        body.enter(element);
        if (element.name == "vertex") {
            read_vertices(element, body, mesh);
        } else if (element.name == "face") {
            polygons = read_faces(element, body);
        } else {
            for (std::size_t row = 0; row < element.count; ++row, body.next_row())
                for (const auto& property : element.properties)
                    body.skip(property);
        }
    }
    if (!polygons) throw InputError(name + ": has no faces: expected a mesh, found a point cloud");
    add_polygons(*polygons, name, mesh);
    return mesh;
}

TriangleMesh read_ply(const std::filesystem::path& path)
{
    const std::string text = read_text(path);
    return parse_ply(std::as_bytes(std::span(text)), path.string());
}

void write_ply(const std::filesystem::path& path, const TriangleMesh& mesh, const PlyFaceData& faces)
{
    const std::string header = header_of(mesh, faces);
    std::vector<std::byte> bytes;
    bytes.reserve(header.size() + 27 * mesh.position.size() + 20 * mesh.face.size());
    for (const char c : header)
        append(bytes, c);
    for (std::size_t v = 0; v < mesh.position.size(); ++v) {
        append(bytes, std::array{mesh.position[v].x(), mesh.position[v].y(), mesh.position[v].z()});
        if (!mesh.normal.empty()) append(bytes, std::array{mesh.normal[v].x(), mesh.normal[v].y(), mesh.normal[v].z()});
        if (!mesh.color.empty()) append(bytes, mesh.color[v]);
    }
    for (std::size_t f = 0; f < mesh.face.size(); ++f) {
        append(bytes, std::uint8_t{3});
        append(bytes, mesh.face[f]);
        if (!faces.color.empty()) append(bytes, faces.color[f]);
        if (!faces.plane.empty()) append(bytes, faces.plane[f]); // kNoPlane has the bits of -1
    }
    write_atomically(path, bytes);
}

} // namespace quoin
