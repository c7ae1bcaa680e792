// Between the units inside (radians, metres) and those that people read and write.
#pragma once

#include <numbers>

namespace quoin {

inline constexpr double kMillimetres = 1000.0;               // in a metre
inline constexpr double kDegrees = 180.0 / std::numbers::pi; // in a radian

inline double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

} // namespace quoin
