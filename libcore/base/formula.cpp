#include "base/formula.h"

#include "base/error.h"

#include <cctype>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <string_view>

namespace quoin {
namespace {

// Recursive descent: sum = product {+- product}, product = factor {*/ factor}, factor = number | name | (sum).
// A value that is not known makes the whole unknown, but the formula is read to its end.
class Reader {
public:
    Reader(const std::string& formula, const FormulaSource& source) : formula_(formula), rest_(formula), source_(source)
    {
    }

    std::optional<double> read()
    {
        const auto value = sum();
        if (next() != '\0') fail();
        return value;
    }

private:
    using Value = std::optional<double>;

    [[noreturn]] void fail() const
    {
        throw UsageError(fmt::format("'{}' is no formula like 'bytes(mesh) * 16 + 200M': '{}' was not expected",
                                     formula_, rest_.empty() ? std::string_view("its end") : rest_));
    }

    char next()
    {
        while (!rest_.empty() && rest_.front() == ' ')
            rest_.remove_prefix(1);
        return rest_.empty() ? '\0' : rest_.front();
    }

    bool take(char wanted)
    {
        if (next() != wanted) return false;
        rest_.remove_prefix(1);
        return true;
    }

    Value sum()
    {
        Value value = product();
        while (next() == '+' || next() == '-') {
            const double sign = take('+') ? 1.0 : (take('-'), -1.0);
            const Value other = product();
            value = value && other ? Value(*value + sign * *other) : std::nullopt;
        }
        return value;
    }

    Value product()
    {
        Value value = factor();
        while (next() == '*' || next() == '/') {
            const bool is_product = take('*');
            if (!is_product) take('/');
            const Value other = factor();
            value = value && other ? Value(is_product ? *value * *other : *value / *other) : std::nullopt;
        }
        return value;
    }

    Value factor()
    {
        if (take('(')) {
            const Value value = sum();
            if (!take(')')) fail();
            return value;
        }
        const char first = next();
        if (std::isdigit(static_cast<unsigned char>(first))) return number();
        const std::string word = name();
        if (word.empty()) fail();
        if (!take('(')) return source_.value(word);
        const std::string port = name();
        if (word != "bytes" || port.empty() || !take(')')) fail();
        return source_.bytes(port);
    }

    double number()
    {
        double value = 0.0;
        const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
        rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
        constexpr std::string_view kUnits = "KMG";
        const std::size_t power = rest_.empty() ? std::string_view::npos : kUnits.find(rest_.front());
        if (power == std::string_view::npos) return value;
        rest_.remove_prefix(1);
        return std::ldexp(value, static_cast<int>(10 * (power + 1)));
    }

    std::string name()
    {
        next();
        const auto is_letter = [](char c) {
            return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-';
        };
        std::size_t length = 0;
        while (length < rest_.size() && is_letter(rest_[length]))
            ++length;
        std::string word(rest_.substr(0, length));
        rest_.remove_prefix(length);
        return word;
    }

    const std::string& formula_;
    std::string_view rest_;
    const FormulaSource& source_;
};

} // namespace

std::optional<double> evaluate_formula(const std::string& formula, const FormulaSource& source)
{
    return Reader(formula, source).read();
}

} // namespace quoin
