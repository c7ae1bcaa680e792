#include "artifact/artifact.h"

#include "artifact/digest.h"
#include "base/error.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numeric>

namespace quoin {

std::size_t size_of(DType type)
{
    constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8, 8, 8};
    return sizes[static_cast<int>(type)];
}

std::string_view name_of(DType type)
{
    constexpr std::string_view names[] = {"U8", "I8", "U16", "I16", "U32", "I32", "F32", "U64", "I64", "F64"};
    return names[static_cast<int>(type)];
}

void Artifact::add_shared(const std::string& name, Tensor tensor)
{
    const std::size_t count =
        std::accumulate(tensor.shape.begin(), tensor.shape.end(), std::size_t{1}, std::multiplies<>());
    if (count * size_of(tensor.type) != tensor.bytes.size())
        throw std::logic_error("tensor '" + name + "': shape and bytes disagree");
    tensors[name] = std::move(tensor);
}

void Artifact::add_bytes(const std::string& name, DType type, std::vector<std::size_t> shape,
                         std::span<const std::byte> bytes)
{
    const auto buffer = std::make_shared<std::vector<std::byte>>(bytes.begin(), bytes.end());
    add_shared(name, {type, std::move(shape), *buffer, buffer});
}

void Artifact::add_text(const std::string& name, const std::string& text)
{
    add_bytes(name, DType::U8, {text.size()}, std::as_bytes(std::span(text)));
}

std::vector<std::string> file_order(const std::map<std::string, Tensor>& tensors)
{
    std::vector<std::string> names;
    for (const auto& [name, tensor] : tensors)
        names.push_back(name);
    std::ranges::stable_sort(
        names, [&](const auto& a, const auto& b) { return size_of(tensors.at(a).type) > size_of(tensors.at(b).type); });
    return names;
}

std::string Artifact::payload() const
{
    nlohmann::json table = nlohmann::json::array();
    const auto names = file_order(tensors);
    for (const auto& name : names)
        table.push_back({name, name_of(tensors.at(name).type), tensors.at(name).shape});
    Sha256Stream stream;
    stream.update(nlohmann::json{{"schema", schema}, {"schema_version", schema_version}, {"tensors", table}}.dump());
    for (const auto& name : names)
        stream.update(tensors.at(name).bytes);
    return to_hex(stream.finish());
}

} // namespace quoin
