#pragma once

#include "base/metrics.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <string>

namespace quoin::test {

inline bool has(const Metrics& metrics, const std::string& name)
{
    return std::any_of(metrics.begin(), metrics.end(), [&](const Metric& m) { return m.name == name; });
}

// A failure of the test when there is no figure of that name.
inline double value_of(const Metrics& metrics, const std::string& name)
{
    for (const Metric& m : metrics)
        if (m.name == name) return m.value;
    ADD_FAILURE() << "no figure named " << name;
    return std::nan("");
}

} // namespace quoin::test
