// The artifact container: one safetensors file (design: 8-byte little-endian header length, JSON header, raw
// little-endian tensors in C order, no holes). Tensors are ordered by falling element size, then name, and the header
// is padded to 64 bytes, so every array is aligned and used in place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace quoin {

enum class DType : std::uint8_t { U8, I8, U16, I16, U32, I32, F32, U64, I64, F64 };
std::size_t size_of(DType type);
std::string_view name_of(DType type); // "U8", "F32", ... as safetensors spells them

template <class T>
constexpr DType dtype_of();
template <>
constexpr DType dtype_of<std::uint8_t>()
{
    return DType::U8;
}
template <>
constexpr DType dtype_of<std::int8_t>()
{
    return DType::I8;
}
template <>
constexpr DType dtype_of<std::uint16_t>()
{
    return DType::U16;
}
template <>
constexpr DType dtype_of<std::uint32_t>()
{
    return DType::U32;
}
template <>
constexpr DType dtype_of<std::int32_t>()
{
    return DType::I32;
}
template <>
constexpr DType dtype_of<float>()
{
    return DType::F32;
}
template <>
constexpr DType dtype_of<double>()
{
    return DType::F64;
}

struct Tensor {
    DType type = DType::U8;
    std::vector<std::size_t> shape;
    std::span<const std::byte> bytes;  // C order
    std::shared_ptr<const void> owner; // keeps the bytes alive: a mapped file or a buffer
};

// A set of named tensors with its schema and provenance. Copies share the bytes.
struct Artifact {
    std::string schema; // "plane_mesh"
    int schema_version = 1;
    std::map<std::string, Tensor> tensors;
    std::map<std::string, std::string> metadata; // every "quoin.*" string of the file but schema and version

    // Adds a tensor by copying `values`; T is trivially copyable and made of `shape`'s elements of type Element.
    template <class Element, class T>
    void add(const std::string& name, std::vector<std::size_t> shape, const std::vector<T>& values)
    {
        static_assert(std::is_trivially_copyable_v<T> || sizeof(T) % sizeof(Element) == 0);
        const DType type = dtype_of<Element>();
        const std::span<const std::byte> bytes = std::as_bytes(std::span(values));
        add_bytes(name, type, std::move(shape), bytes);
    }
    // The same, but the values are not copied.
    template <class Element, class T>
    void add(const std::string& name, std::vector<std::size_t> shape, std::vector<T>&& values)
    {
        static_assert(std::is_trivially_copyable_v<T> || sizeof(T) % sizeof(Element) == 0);
        const auto owner = std::make_shared<const std::vector<T>>(std::move(values));
        add_shared(name, {dtype_of<Element>(), std::move(shape), std::as_bytes(std::span(*owner)), owner});
    }
    void add_shared(const std::string& name, Tensor tensor);
    void add_bytes(const std::string& name, DType type, std::vector<std::size_t> shape,
                   std::span<const std::byte> bytes);
    void add_text(const std::string& name, const std::string& text); // (length) u8

    // SHA-256, in hexadecimal, over the canonical tensor table and the tensor bytes, without provenance.
    std::string payload() const;
};

// Names of tensors in the order they have in a file: by falling element size, then name.
std::vector<std::string> file_order(const std::map<std::string, Tensor>& tensors);

// What the header alone tells, without reading a tensor.
struct ArtifactHeader {
    std::string schema;
    int schema_version = 0;
    std::string payload; // hexadecimal
    std::map<std::string, std::string> metadata;
    std::uint64_t file_size = 0;
};
ArtifactHeader read_artifact_header(const std::filesystem::path& path);

// Maps the file and checks container, lengths, offsets and checksums. Throws InputError that says what was found, what
// is readable, who wrote it and what to do.
Artifact read_artifact(const std::filesystem::path& path);
// The same, and the schema must be `schema` at a version up to `newest` (older ones are migrated).
Artifact read_artifact(const std::filesystem::path& path, std::string_view schema, int newest = 1);

// Writes atomically. Metadata of the artifact is written along; payload and checksums are added. Returns the payload.
std::string write_artifact(const std::filesystem::path& path, const Artifact& artifact);

} // namespace quoin
