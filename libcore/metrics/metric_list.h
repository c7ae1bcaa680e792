#pragma once

#include "base/metrics.h"

#include <cmath>
#include <numbers>
#include <string>

namespace quoin {

inline constexpr double kMillimetres = 1000.0;               // in a metre
inline constexpr double kDegrees = 180.0 / std::numbers::pi; // in a radian

// Collects figures; one that could not be measured (NaN) is left out.
class MetricList {
public:
    void lower(const std::string& name, const std::string& unit, double value)
    {
        add(name, unit, value, Better::Lower);
    }
    void higher(const std::string& name, const std::string& unit, double value)
    {
        add(name, unit, value, Better::Higher);
    }
    void plain(const std::string& name, const std::string& unit, double value)
    {
        add(name, unit, value, Better::Neither);
    }
    Metrics take() { return std::move(metrics_); }

private:
    void add(const std::string& name, const std::string& unit, double value, Better better)
    {
        if (std::isfinite(value)) metrics_.push_back({name, unit, value, better});
    }
    Metrics metrics_;
};

} // namespace quoin
