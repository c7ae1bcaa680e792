#pragma once

#include "base/metrics.h"
#include "geometry/units.h"

#include <cmath>
#include <string>

namespace quoin {

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
