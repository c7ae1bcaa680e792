#include "artifact/difference.h"

#include <algorithm>
#include <cstring>
#include <fmt/format.h>
#include <set>

namespace quoin {
namespace {

template <class Element>
std::string text_at(const Tensor& tensor, std::size_t index)
{
    Element value{};
    std::memcpy(&value, tensor.bytes.data() + index * sizeof(Element), sizeof(Element));
    return fmt::format("{}", value);
}

std::string index_text(const Tensor& tensor, std::size_t index)
{
    std::vector<std::size_t> place(tensor.shape.size());
    for (std::size_t i = place.size(); i-- > 0;) {
        place[i] = index % tensor.shape[i];
        index /= tensor.shape[i];
    }
    return fmt::format("({})", fmt::join(place, ", "));
}

std::string compare(const std::string& name, const Tensor& first, const Tensor& second)
{
    if (first.type != second.type)
        return fmt::format("tensor '{}': type {}, {}", name, name_of(first.type), name_of(second.type));
    if (first.shape != second.shape)
        return fmt::format("tensor '{}': shape ({}), ({})", name, fmt::join(first.shape, ", "),
                           fmt::join(second.shape, ", "));
    const auto differs = std::ranges::mismatch(first.bytes, second.bytes);
    if (differs.in1 == first.bytes.end()) return {};
    const auto index = static_cast<std::size_t>(differs.in1 - first.bytes.begin()) / size_of(first.type);
    return fmt::format("tensor '{}' at {}: {}, {}", name, index_text(first, index), element_text(first, index),
                       element_text(second, index));
}

} // namespace

std::string element_text(const Tensor& tensor, std::size_t index)
{
    switch (tensor.type) {
    case DType::U8:
        return text_at<std::uint8_t>(tensor, index);
    case DType::I8:
        return text_at<std::int8_t>(tensor, index);
    case DType::U16:
        return text_at<std::uint16_t>(tensor, index);
    case DType::I16:
        return text_at<std::int16_t>(tensor, index);
    case DType::U32:
        return text_at<std::uint32_t>(tensor, index);
    case DType::I32:
        return text_at<std::int32_t>(tensor, index);
    case DType::F32:
        return text_at<float>(tensor, index);
    case DType::U64:
        return text_at<std::uint64_t>(tensor, index);
    case DType::I64:
        return text_at<std::int64_t>(tensor, index);
    case DType::F64:
        return text_at<double>(tensor, index);
    }
    return {};
}

std::optional<std::string> first_difference(const Artifact& first, const Artifact& second)
{
    if (first.schema != second.schema) return fmt::format("schema {}, {}", first.schema, second.schema);
    std::set<std::string> names;
    for (const auto* artifact : {&first, &second})
        for (const auto& [name, tensor] : artifact->tensors)
            names.insert(name);
    for (const auto& name : names) {
        if (!first.tensors.contains(name)) return fmt::format("tensor '{}' is only in the second", name);
        if (!second.tensors.contains(name)) return fmt::format("tensor '{}' is only in the first", name);
        if (auto text = compare(name, first.tensors.at(name), second.tensors.at(name)); !text.empty()) return text;
    }
    return std::nullopt;
}

} // namespace quoin
