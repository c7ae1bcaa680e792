// Typed access to an artifact's tensors, with every shape and index checked.
#pragma once

#include "artifact/artifact.h"

#include <cstring>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

namespace quoin {

inline constexpr std::size_t kAny = static_cast<std::size_t>(-1);

// Reads tensors of one artifact; errors name the file and the tensor.
class TensorReader {
public:
    TensorReader(const Artifact& artifact, std::filesystem::path path) : artifact_(&artifact), path_(std::move(path)) {}

    bool has(const std::string& name) const { return artifact_->tensors.contains(name); }

    // A tensor of exactly this type and shape (kAny leaves a length open), as one T per entry of the first dimension;
    // T holds the elements of the others: array<"face", u32, Face>({kAny, 3}).
    template <class Element, class T>
    std::vector<T> array(const std::string& name, std::initializer_list<std::size_t> shape) const
    {
        const Tensor& tensor = checked(name, dtype_of<Element>(), shape);
        const std::size_t count = tensor.shape.empty() ? 1 : tensor.shape[0];
        check_row(name, tensor, sizeof(T));
        if constexpr (alignof(T) <= sizeof(Element)) { // as aligned as the tensor: no need to clear the memory first
            const T* first = reinterpret_cast<const T*>(tensor.bytes.data());
            return count > 0 ? std::vector<T>(first, first + count) : std::vector<T>();
        }
        std::vector<T> values(count);
        if (count > 0) std::memcpy(static_cast<void*>(values.data()), tensor.bytes.data(), tensor.bytes.size());
        return values;
    }
    std::string text(const std::string& name) const;
    std::vector<std::string> lines(const std::string& name, std::size_t count) const; // '\n' after each

    // Refuses when the tensors `name` and `other` should be equally long and are not.
    void check_length(const std::string& name, std::size_t found, const std::string& other, std::size_t expected) const;
    // Refuses an index that is not below `limit`.
    void check_indices(const std::string& name, const std::uint32_t* values, std::size_t count,
                       std::size_t limit) const;
    void check_finite(const std::string& name, const double* values, std::size_t count) const;
    [[noreturn]] void refuse(const std::string& name, const std::string& problem) const;

private:
    const Tensor& checked(const std::string& name, DType type, std::initializer_list<std::size_t> shape) const;
    void check_row(const std::string& name, const Tensor& tensor, std::size_t row) const;

    const Artifact* artifact_;
    std::filesystem::path path_;
};

std::string joined_lines(const std::vector<std::string>& lines); // '\n' after each

} // namespace quoin
