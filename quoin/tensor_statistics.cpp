#include "quoin/tensor_statistics.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace quoin {
namespace {

template <class T>
std::optional<TensorStatistics> statistics_as(const Tensor& tensor)
{
    constexpr double infinity = std::numeric_limits<double>::infinity();
    TensorStatistics statistics{infinity, -infinity, 0.0, 0};
    const std::size_t count = tensor.bytes.size() / sizeof(T);
    for (std::size_t i = 0; i < count; ++i) {
        T element;
        std::memcpy(&element, tensor.bytes.data() + i * sizeof(T), sizeof(T));
        const auto value = static_cast<double>(element);
        if (!std::isfinite(value)) {
            ++statistics.not_finite;
            continue;
        }
        statistics.min = std::min(statistics.min, value);
        statistics.max = std::max(statistics.max, value);
        statistics.mean += value;
    }
    if (count == statistics.not_finite) return std::nullopt;
    statistics.mean /= static_cast<double>(count - statistics.not_finite);
    return statistics;
}

} // namespace

std::optional<TensorStatistics> statistics_of(const Tensor& tensor)
{
    switch (tensor.type) {
    case DType::U8:
        return statistics_as<std::uint8_t>(tensor);
    case DType::I8:
        return statistics_as<std::int8_t>(tensor);
    case DType::U16:
        return statistics_as<std::uint16_t>(tensor);
    case DType::I16:
        return statistics_as<std::int16_t>(tensor);
    case DType::U32:
        return statistics_as<std::uint32_t>(tensor);
    case DType::I32:
        return statistics_as<std::int32_t>(tensor);
    case DType::F32:
        return statistics_as<float>(tensor);
    case DType::U64:
        return statistics_as<std::uint64_t>(tensor);
    case DType::I64:
        return statistics_as<std::int64_t>(tensor);
    case DType::F64:
        return statistics_as<double>(tensor);
    }
    return std::nullopt;
}

} // namespace quoin
