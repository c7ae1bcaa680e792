// Other values of parameters, right and wrong, and other orders of arguments: what a stage is tested with.
#pragma once

#include "base/param.h"

#include <optional>
#include <string>
#include <vector>

namespace quoin {

// A name that no parameter has, near to `name` if there is one.
std::string misspelt(const std::string& name, const std::vector<ParamSpec>& params);

// Texts that a number's interval refuses; "nan" for every float.
std::vector<std::string> texts_out_of_range(const ParamSpec& spec);

// A right value other than the default, if there is one.
std::optional<std::string> other_value(const ParamSpec& spec);

// The same options (pairs of flag and value) from the last to the first.
std::vector<std::string> reordered(const std::vector<std::string>& arguments);

} // namespace quoin
