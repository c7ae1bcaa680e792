#include "model/writers.h"

#include "base/atomic_file.h"

#include <fmt/format.h>
#include <iterator>

namespace quoin {
namespace {

constexpr float kWhite = 255.0f;

std::string material_name(const Model& model, std::uint32_t page)
{
    return model.has_texture() ? fmt::format("page_{}", page) : "surface";
}

void append_vertices(const Primitive& primitive, std::string& text)
{
    auto out = std::back_inserter(text);
    for (std::size_t i = 0; i < primitive.position.size(); ++i) {
        const auto& p = primitive.position[i];
        fmt::format_to(out, "v {} {} {}", p.x(), p.y(), p.z());
        if (!primitive.color.empty()) {
            const auto& c = primitive.color[i];
            fmt::format_to(out, " {:.4f} {:.4f} {:.4f}", static_cast<float>(c[0]) / kWhite,
                           static_cast<float>(c[1]) / kWhite, static_cast<float>(c[2]) / kWhite);
        }
        text += '\n';
    }
    for (const auto& uv : primitive.uv)
        fmt::format_to(out, "vt {} {}\n", uv.x(), 1.0f - uv.y()); // v runs up in OBJ
    for (const auto& n : primitive.normal)
        fmt::format_to(out, "vn {} {} {}\n", n.x(), n.y(), n.z());
}

// first: index of the primitive's first vertex, counted from 1; vt and vn are numbered alike.
void append_faces(const Model& model, const Primitive& primitive, std::size_t first, std::string& text)
{
    auto out = std::back_inserter(text);
    PlaneId plane = kNoPlane;
    for (std::size_t f = 0; f < primitive.face.size(); ++f) {
        if (model.has_planes() && model.face_plane[primitive.source[f]] != plane) {
            plane = model.face_plane[primitive.source[f]];
            fmt::format_to(out, "g plane_{}\n", plane);
        }
        text += 'f';
        for (const auto v : primitive.face[f]) {
            const std::size_t i = first + v;
            fmt::format_to(out, " {}", i);
            if (!primitive.uv.empty()) fmt::format_to(out, "/{}", i);
            if (!primitive.normal.empty()) fmt::format_to(out, "{}/{}", primitive.uv.empty() ? "/" : "", i);
        }
        text += '\n';
    }
}

std::string materials(const Model& model)
{
    std::string text = fmt::format("# {}\n", model.generator);
    const auto add = [&](const std::string& name) {
        text += fmt::format("newmtl {}\nKa 0 0 0\nKd 1 1 1\nKs 0 0 0\nillum 1\n", name);
    };
    if (!model.has_texture()) add("surface");
    for (std::uint32_t p = 0; p < model.page.size(); ++p) {
        add(material_name(model, p));
        text += fmt::format("map_Kd {}\n", model.page[p].file);
    }
    return text;
}

} // namespace

void write_obj(const Model& model, const std::vector<Primitive>& primitives, const std::filesystem::path& path)
{
    std::filesystem::path material_path = path;
    material_path.replace_extension(".mtl");
    std::string text =
        fmt::format("# {}: metres, +Y up\nmtllib {}\n", model.generator, material_path.filename().string());
    std::size_t first = 1;
    for (const auto& primitive : primitives) {
        append_vertices(primitive, text);
        text += fmt::format("usemtl {}\n", material_name(model, primitive.page));
        append_faces(model, primitive, first, text);
        first += primitive.position.size();
    }
    write_atomically(path, std::string_view(text));
    write_atomically(material_path, std::string_view(materials(model)));
}

} // namespace quoin
