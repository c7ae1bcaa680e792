#pragma once

#include "artifact/artifact.h"

#include <optional>
#include <string>

namespace quoin {

// The first tensor, by name, in which two artifacts differ, and where: "tensor 'plane' at (3, 1): 0.25, 0.5". None when
// they hold the same tensors; provenance is not compared.
std::optional<std::string> first_difference(const Artifact& first, const Artifact& second);

// The element at `index`, counted in C order, as text.
std::string element_text(const Tensor& tensor, std::size_t index);

} // namespace quoin
