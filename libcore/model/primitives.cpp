#include "model/primitives.h"

#include <algorithm>
#include <compare>

namespace quoin {
namespace {

// What makes two corners of the mesh one vertex of a primitive.
struct CornerKey {
    VertexId vertex;
    std::uint32_t part; // uv, else plane, else 0
    auto operator<=>(const CornerKey&) const = default;
};

CornerKey corner_key(const Model& model, FaceId f, std::size_t k)
{
    const std::uint32_t part = model.has_texture()  ? model.texture->corner_uv[f][k]
                               : model.has_planes() ? model.face_plane[f]
                                                    : 0;
    return {model.mesh.face[f][k], part};
}

bool is_proper(const Face& face) { return face[0] != face[1] && face[1] != face[2] && face[2] != face[0]; }

void set_normals(const Model& model, Primitive& primitive)
{
    primitive.normal.assign(primitive.position.size(), Eigen::Vector3f::Zero());
    for (std::size_t i = 0; i < primitive.face.size(); ++i) {
        const Eigen::Vector3f area = area_vector(model.mesh, primitive.source[i]).cast<float>();
        for (const auto v : primitive.face[i])
            primitive.normal[v] += area;
    }
    for (std::size_t i = 0; i < primitive.face.size(); ++i) // a vertex of zero-area faces only takes its plane's normal
        for (const auto v : primitive.face[i])
            if (primitive.normal[v].isZero(0.0f))
                primitive.normal[v] =
                    model.has_planes()
                        ? Eigen::Vector3f(model.plane[model.face_plane[primitive.source[i]]].normal.cast<float>())
                        : Eigen::Vector3f::UnitY();
    for (auto& n : primitive.normal)
        n = n.cast<double>().normalized().cast<float>();
}

void add_vertex(const Model& model, const CornerKey& key, Primitive& primitive)
{
    primitive.vertex.push_back(key.vertex);
    primitive.position.push_back(model.mesh.position[key.vertex]);
    if (model.has_texture())
        primitive.uv.push_back(model.texture->uv[key.part]);
    else if (model.has_planes())
        primitive.color.push_back(model.plane_color[key.part]);
    else if (!model.mesh.color.empty())
        primitive.color.push_back(model.mesh.color[key.vertex]);
}

Primitive make_primitive(const Model& model, std::uint32_t page, std::vector<FaceId> faces)
{
    std::vector<CornerKey> keys;
    for (const FaceId f : faces)
        for (std::size_t k = 0; k < 3; ++k)
            keys.push_back(corner_key(model, f, k));
    std::ranges::sort(keys);
    keys.erase(std::ranges::unique(keys).begin(), keys.end());

    Primitive primitive;
    primitive.page = page;
    for (const auto& key : keys)
        add_vertex(model, key, primitive);
    for (const FaceId f : faces) {
        Face face{};
        for (std::size_t k = 0; k < 3; ++k)
            face[k] = static_cast<VertexId>(std::ranges::lower_bound(keys, corner_key(model, f, k)) - keys.begin());
        primitive.face.push_back(face);
    }
    primitive.source = std::move(faces);
    return primitive;
}

} // namespace

std::vector<Primitive> make_primitives(const Model& model, bool with_normals)
{
    std::vector<std::vector<FaceId>> faces(std::max<std::size_t>(model.page.size(), 1));
    for (FaceId f = 0; f < model.mesh.face.size(); ++f)
        if (is_proper(model.mesh.face[f])) faces[model.has_texture() ? model.texture->face_page[f] : 0].push_back(f);
    std::vector<Primitive> primitives;
    for (std::uint32_t page = 0; page < faces.size(); ++page) {
        if (faces[page].empty()) continue;
        primitives.push_back(make_primitive(model, page, std::move(faces[page])));
        if (with_normals) set_normals(model, primitives.back());
    }
    return primitives;
}

} // namespace quoin
