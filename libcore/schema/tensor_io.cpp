#include "schema/tensor_io.h"

#include "base/error.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace quoin {

void TensorReader::refuse(const std::string& name, const std::string& problem) const
{
    throw InputError(fmt::format("{}: tensor '{}' of the {}: {}; make the file again", path_.string(), name,
                                 artifact_->schema, problem));
}

const Tensor& TensorReader::checked(const std::string& name, DType type, std::initializer_list<std::size_t> shape) const
{
    const auto it = artifact_->tensors.find(name);
    if (it == artifact_->tensors.end()) refuse(name, "is missing");
    const Tensor& tensor = it->second;
    const bool fits =
        tensor.type == type && std::ranges::equal(tensor.shape, shape, [](std::size_t found, std::size_t wanted) {
            return wanted == kAny || found == wanted;
        });
    if (fits) return tensor;
    std::vector<std::string> wanted;
    for (const std::size_t n : shape)
        wanted.push_back(n == kAny ? "n" : std::to_string(n));
    refuse(name, fmt::format("is {} ({}), expected {} ({})", name_of(tensor.type), fmt::join(tensor.shape, ","),
                             name_of(type), fmt::join(wanted, ",")));
}

void TensorReader::check_row(const std::string& name, const Tensor& tensor, std::size_t row) const
{
    const std::size_t count = tensor.shape.empty() ? 1 : tensor.shape[0];
    if (count * row != tensor.bytes.size())
        refuse(name, fmt::format("has {} bytes, expected {}", tensor.bytes.size(), count * row));
}

std::string TensorReader::text(const std::string& name) const
{
    const auto bytes = array<std::uint8_t, char>(name, {kAny});
    return {bytes.begin(), bytes.end()};
}

std::vector<std::string> TensorReader::lines(const std::string& name, std::size_t count) const
{
    std::vector<std::string> lines;
    const std::string all = text(name);
    for (std::size_t begin = 0; begin < all.size();) {
        const std::size_t end = std::min(all.find('\n', begin), all.size());
        lines.push_back(all.substr(begin, end - begin));
        begin = end + 1;
    }
    check_length(name, lines.size(), "frames", count);
    return lines;
}

void TensorReader::check_length(const std::string& name, std::size_t found, const std::string& other,
                                std::size_t expected) const
{
    if (found != expected) refuse(name, fmt::format("has {} entries, '{}' has {}", found, other, expected));
}

void TensorReader::check_indices(const std::string& name, const std::uint32_t* values, std::size_t count,
                                 std::size_t limit) const
{
    constexpr std::size_t kGrain = 1 << 16;
    const auto largest_of = [&](std::size_t begin, std::size_t end) {
        return begin < end ? *std::max_element(values + begin, values + end) : 0u;
    };
    const auto larger = [](std::uint32_t x, std::uint32_t y) { return std::max(x, y); };
    if (count == 0 || parallel_reduce(count, kGrain, 0u, largest_of, larger) < limit) return;
    for (std::size_t i = 0; i < count; ++i)
        if (values[i] >= limit)
            refuse(name, fmt::format("entry {} is {}, expected an index below {}", i, values[i], limit));
}

void TensorReader::check_finite(const std::string& name, const double* values, std::size_t count) const
{
    for (std::size_t i = 0; i < count; ++i)
        if (!std::isfinite(values[i])) refuse(name, fmt::format("number {} is not finite", i));
}

std::string joined_lines(const std::vector<std::string>& lines)
{
    std::string text;
    for (const auto& line : lines)
        text += line + '\n';
    return text;
}

} // namespace quoin
