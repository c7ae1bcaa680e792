#include "compare/compare.h"

#include "artifact/difference.h"
#include "base/error.h"
#include "compare/schemas.h"

#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <map>
#include <set>

namespace quoin {
namespace fs = std::filesystem;
namespace {

template <class Element>
double element_at(const Tensor& tensor, std::size_t index)
{
    Element value{};
    std::memcpy(&value, tensor.bytes.data() + index * sizeof(Element), sizeof(Element));
    return static_cast<double>(value);
}

double value_at(const Tensor& tensor, std::size_t index)
{
    switch (tensor.type) {
    case DType::U8:
        return element_at<std::uint8_t>(tensor, index);
    case DType::I8:
        return element_at<std::int8_t>(tensor, index);
    case DType::U16:
        return element_at<std::uint16_t>(tensor, index);
    case DType::I16:
        return element_at<std::int16_t>(tensor, index);
    case DType::U32:
        return element_at<std::uint32_t>(tensor, index);
    case DType::I32:
        return element_at<std::int32_t>(tensor, index);
    case DType::F32:
        return element_at<float>(tensor, index);
    case DType::U64:
        return element_at<std::uint64_t>(tensor, index);
    case DType::I64:
        return element_at<std::int64_t>(tensor, index);
    case DType::F64:
        return element_at<double>(tensor, index);
    }
    return 0.0;
}

std::string shape_text(const Tensor& tensor)
{
    return fmt::format("{} ({})", name_of(tensor.type), fmt::join(tensor.shape, ", "));
}

// "" when the tensors are equal.
std::string compare_tensors(const std::string& name, const Tensor& first, const Tensor& second)
{
    if (first.type != second.type || first.shape != second.shape)
        return fmt::format("tensor {:<20} {}, {}", name, shape_text(first), shape_text(second));
    const std::size_t count = first.bytes.size() / size_of(first.type);
    std::size_t different = 0;
    double largest = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t at = i * size_of(first.type);
        if (std::memcmp(first.bytes.data() + at, second.bytes.data() + at, size_of(first.type)) == 0) continue;
        ++different;
        largest = std::max(largest, std::abs(value_at(first, i) - value_at(second, i)));
    }
    if (different == 0) return {};
    return fmt::format("tensor {:<20} {} of {} elements differ, by up to {:.6g}", name, different, count, largest);
}

void compare_all_tensors(const Artifact& first, const Artifact& second, Comparison& comparison)
{
    std::set<std::string> names;
    for (const auto* artifact : {&first, &second})
        for (const auto& [name, tensor] : artifact->tensors)
            names.insert(name);
    for (const auto& name : names) {
        const bool in_first = first.tensors.contains(name), in_second = second.tensors.contains(name);
        std::string line = !in_first    ? fmt::format("tensor {:<20} is only in the second", name)
                           : !in_second ? fmt::format("tensor {:<20} is only in the first", name)
                                        : compare_tensors(name, first.tensors.at(name), second.tensors.at(name));
        if (!line.empty()) comparison.lines.push_back(std::move(line));
    }
    comparison.is_equal = comparison.lines.empty();
}

} // namespace

Comparison compare_artifacts(const fs::path& first, const fs::path& second)
{
    using Compare = std::vector<std::string> (*)(const fs::path&, const fs::path&);
    static const std::map<std::string, Compare> by_schema{
        {"mesh", compare_meshes},
        {"plane_mesh", compare_plane_meshes},
        {"textured_mesh", compare_textured_meshes},
        {"alignment", compare_alignments},
        {"scan", compare_scans},
        {"keyframes", compare_keyframes},
        {"metrics", compare_metrics},
    };
    const Artifact a = read_artifact(first), b = read_artifact(second);
    if (a.schema != b.schema)
        throw InputError(fmt::format("{} is a '{}', {} is a '{}': only two of one schema can be compared",
                                     first.string(), a.schema, second.string(), b.schema));
    Comparison comparison;
    compare_all_tensors(a, b, comparison);
    const auto compare = by_schema.find(a.schema);
    if (comparison.is_equal || compare == by_schema.end()) return comparison;
    for (auto& line : compare->second(first, second))
        comparison.lines.push_back(std::move(line));
    return comparison;
}

} // namespace quoin
