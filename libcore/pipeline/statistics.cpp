#include "pipeline/statistics.h"

#include <cmath>

namespace quoin {
namespace {

constexpr double kConfidence = 0.95;

// Lentz's continued fraction of the incomplete beta function (Numerical Recipes, 6.4).
double beta_fraction(double a, double b, double x)
{
    constexpr double kTiny = 1e-300;
    constexpr double kEpsilon = 1e-16;
    constexpr int kMaxTerms = 500;
    const auto away_from_zero = [](double value) { return std::abs(value) < kTiny ? kTiny : value; };
    double c = 1.0;
    double d = 1.0 / away_from_zero(1.0 - (a + b) * x / (a + 1.0));
    double fraction = d;
    for (int m = 1; m < kMaxTerms; ++m) {
        const double even = m * (b - m) * x / ((a + 2 * m - 1.0) * (a + 2 * m));
        d = 1.0 / away_from_zero(1.0 + even * d);
        c = away_from_zero(1.0 + even / c);
        fraction *= d * c;
        const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1.0));
        d = 1.0 / away_from_zero(1.0 + odd * d);
        c = away_from_zero(1.0 + odd / c);
        fraction *= d * c;
        if (std::abs(d * c - 1.0) < kEpsilon) break;
    }
    return fraction;
}

// The regularised incomplete beta function I_x(a, b).
double incomplete_beta(double a, double b, double x)
{
    if (x <= 0.0) return 0.0;
    if (x >= 1.0) return 1.0;
    const double front =
        std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
    // The fraction converges fast on this side of the mean only.
    if (x < (a + 1.0) / (a + b + 2.0)) return front * beta_fraction(a, b, x) / a;
    return 1.0 - front * beta_fraction(b, a, 1.0 - x) / b;
}

// The probability that a Student variable is below t >= 0.
double student_probability(double t, double freedom)
{
    return 1.0 - 0.5 * incomplete_beta(0.5 * freedom, 0.5, freedom / (freedom + t * t));
}

} // namespace

double student_quantile(double probability, double freedom)
{
    double low = 0.0;
    double high = 1.0;
    while (student_probability(high, freedom) < probability)
        high *= 2.0;
    constexpr int kHalvings = 100; // beyond the digits of a double
    for (int i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (low + high);
        (student_probability(middle, freedom) < probability ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

PairedDifference paired_difference(const std::vector<double>& base, const std::vector<double>& changed)
{
    PairedDifference result;
    result.pairs = base.size();
    if (base.empty()) return result;
    const auto n = static_cast<double>(base.size());
    for (std::size_t i = 0; i < base.size(); ++i)
        result.mean += (changed[i] - base[i]) / n;
    if (base.size() < 2) return result;
    double squares = 0.0;
    for (std::size_t i = 0; i < base.size(); ++i)
        squares += std::pow(changed[i] - base[i] - result.mean, 2);
    const double standard_error = std::sqrt(squares / (n - 1.0) / n);
    result.half_width = student_quantile(0.5 * (1.0 + kConfidence), n - 1.0) * standard_error;
    return result;
}

} // namespace quoin
