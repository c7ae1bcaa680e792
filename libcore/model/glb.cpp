#include "model/writers.h"

#include "base/atomic_file.h"
#include "base/error.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>

namespace quoin {
namespace {
using Json = nlohmann::ordered_json;

// Constants of the glTF 2.0 specification.
constexpr std::uint32_t kMagic = 0x46546c67, kVersion = 2, kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;
constexpr int kFloat = 5126, kUnsignedShort = 5123, kUnsignedInt = 5125;
constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;
constexpr int kLinear = 9729, kLinearMipmapLinear = 9987, kClampToEdge = 33071;
constexpr std::size_t kAlignment = 4;
constexpr std::uint32_t kPrimitiveRestart16 = 65535;

std::string padded(std::string bytes, char fill)
{
    bytes.resize((bytes.size() + kAlignment - 1) / kAlignment * kAlignment, fill);
    return bytes;
}

template <class T>
std::string_view chars_of(const std::vector<T>& values)
{
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

// The document's JSON together with the buffer it describes.
class Glb { // NOLINT(bugprone-exception-escape): its move is that of json, which nlohmann declares never to throw
public:
    std::size_t add_view(std::string_view bytes, int target = 0)
    {
        Json view{{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", bytes.size()}};
        if (target != 0) view["target"] = target;
        binary_ = padded(std::move(binary_.append(bytes)), '\0');
        json["bufferViews"].push_back(view);
        return json["bufferViews"].size() - 1;
    }

    template <class T>
    std::size_t add_accessor(const std::vector<T>& values, Json description, int target = kArrayBuffer)
    {
        description["bufferView"] = add_view(chars_of(values), target);
        json["accessors"].push_back(std::move(description));
        return json["accessors"].size() - 1;
    }

    std::string finish()
    {
        json["buffers"] = Json::array({Json{{"byteLength", binary_.size()}}});
        const std::string text = padded(json.dump(), ' ');
        const std::uint64_t length =
            3 * sizeof(std::uint32_t) + 2 * (2 * sizeof(std::uint32_t)) + text.size() + binary_.size();
        if (length > std::numeric_limits<std::uint32_t>::max())
            throw ImpossibleError("model.glb: the model takes " + std::to_string(length) +
                                  " bytes; the format ends at 4 GiB; bake smaller or JPEG pages");
        std::string file;
        const auto append = [&](std::uint64_t number) {
            const auto word = static_cast<std::uint32_t>(number);
            file.append(reinterpret_cast<const char*>(&word), sizeof word);
        };
        for (const std::uint64_t word : {std::uint64_t{kMagic}, std::uint64_t{kVersion}, length,
                                         std::uint64_t{text.size()}, std::uint64_t{kJsonChunk}})
            append(word);
        file += text;
        append(binary_.size());
        append(kBinaryChunk);
        return file + binary_;
    }

    Json json;

private:
    std::string binary_;
};

std::size_t add_positions(Glb& glb, const std::vector<Eigen::Vector3f>& positions)
{
    Eigen::Vector3f low = positions[0], high = positions[0];
    for (const auto& p : positions) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    return glb.add_accessor(positions, {{"componentType", kFloat},
                                        {"count", positions.size()},
                                        {"type", "VEC3"},
                                        {"min", {low.x(), low.y(), low.z()}},
                                        {"max", {high.x(), high.y(), high.z()}}});
}

std::size_t add_indices(Glb& glb, const Primitive& primitive)
{
    const Json description{{"componentType", kUnsignedInt}, {"count", 3 * primitive.face.size()}, {"type", "SCALAR"}};
    if (primitive.position.size() > kPrimitiveRestart16)
        return glb.add_accessor(primitive.face, description, kElementArrayBuffer);
    std::vector<std::uint16_t> indices;
    for (const auto& face : primitive.face)
        for (const auto v : face)
            indices.push_back(static_cast<std::uint16_t>(v));
    Json small = description;
    small["componentType"] = kUnsignedShort;
    return glb.add_accessor(indices, small, kElementArrayBuffer);
}

// glTF's vertex colours are linear.
std::uint16_t linear16(std::uint8_t srgb)
{
    const double s = srgb / 255.0;
    const double linear = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
    return static_cast<std::uint16_t>(std::lround(linear * 65535.0));
}

std::size_t add_colors(Glb& glb, const std::vector<Rgb8>& colors)
{
    std::vector<std::array<std::uint16_t, 4>> linear;
    for (const auto& c : colors)
        linear.push_back({linear16(c[0]), linear16(c[1]), linear16(c[2]), 65535});
    return glb.add_accessor(
        linear, {{"componentType", kUnsignedShort}, {"normalized", true}, {"count", linear.size()}, {"type", "VEC4"}});
}

Json add_primitive(Glb& glb, const Primitive& primitive)
{
    Json attributes{{"POSITION", add_positions(glb, primitive.position)}};
    if (!primitive.normal.empty())
        attributes["NORMAL"] = glb.add_accessor(
            primitive.normal, {{"componentType", kFloat}, {"count", primitive.normal.size()}, {"type", "VEC3"}});
    if (!primitive.uv.empty())
        attributes["TEXCOORD_0"] = glb.add_accessor(
            primitive.uv, {{"componentType", kFloat}, {"count", primitive.uv.size()}, {"type", "VEC2"}});
    if (!primitive.color.empty()) attributes["COLOR_0"] = add_colors(glb, primitive.color);
    return {{"attributes", attributes}, {"indices", add_indices(glb, primitive)}, {"material", primitive.page}};
}

// Unlit, for the photographs hold the light already; viewers that do not know the extension see a matt surface.
Json material(const std::string& name)
{
    return {{"name", name},
            {"pbrMetallicRoughness", {{"metallicFactor", 0.0}, {"roughnessFactor", 1.0}}},
            {"doubleSided", false},
            {"extensions", {{"KHR_materials_unlit", Json::object()}}}};
}

void add_materials(Glb& glb, const Model& model)
{
    if (model.page.empty()) glb.json["materials"].push_back(material("surface"));
    for (std::size_t p = 0; p < model.page.size(); ++p) {
        const auto& image = model.page[p].page->image;
        const auto view = glb.add_view({reinterpret_cast<const char*>(image.data()), image.size()});
        glb.json["images"].push_back(
            {{"name", model.page[p].file}, {"mimeType", model.page[p].mime}, {"bufferView", view}});
        glb.json["textures"].push_back({{"sampler", 0}, {"source", p}});
        Json page = material("page_" + std::to_string(p));
        page["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", p}};
        glb.json["materials"].push_back(page);
    }
    if (!model.page.empty())
        glb.json["samplers"] = Json::array({Json{{"magFilter", kLinear},
                                                 {"minFilter", kLinearMipmapLinear},
                                                 {"wrapS", kClampToEdge},
                                                 {"wrapT", kClampToEdge}}});
}

Json row_major(const Rigid& transform)
{
    Json rows = Json::array();
    for (int r = 0; r < 4; ++r)
        for (int c = 0; c < 4; ++c)
            rows.push_back(transform.matrix()(r, c));
    return rows;
}

} // namespace

void write_glb(const Model& model, const std::vector<Primitive>& primitives, const std::filesystem::path& path)
{
    Glb glb;
    glb.json["asset"] = {{"version", "2.0"}, {"generator", model.generator}};
    glb.json["extensionsUsed"] = {"KHR_materials_unlit"};
    glb.json["scene"] = 0;
    glb.json["scenes"] = Json::array({Json{
        {"name", "scan"}, {"nodes", {0}}, {"extras", {{"model_from_world", row_major(model.model_from_world)}}}}});
    glb.json["nodes"] = Json::array({Json{{"name", "model"}, {"mesh", 0}}});
    Json pieces = Json::array();
    for (const auto& primitive : primitives)
        pieces.push_back(add_primitive(glb, primitive));
    glb.json["meshes"] = Json::array({Json{{"name", "model"}, {"primitives", pieces}}});
    add_materials(glb, model);
    write_atomically(path, std::string_view(glb.finish()));
}

} // namespace quoin
