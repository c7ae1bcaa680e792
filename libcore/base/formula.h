// Formulas of input size, as stages declare their memory: "bytes(mesh) * 16 + 200M". Numbers may end in K, M or G
// (powers of 1024); bytes(PORT) is the size of an input; other names are given by the caller; + - * / and parentheses.
#pragma once

#include <functional>
#include <optional>
#include <string>

namespace quoin {

struct FormulaSource {
    std::function<std::optional<double>(const std::string& port)> bytes;
    std::function<std::optional<double>(const std::string& name)> value;
};

// None when something in it is not known. Throws UsageError naming the formula when it is none.
std::optional<double> evaluate_formula(const std::string& formula, const FormulaSource& source);

} // namespace quoin
