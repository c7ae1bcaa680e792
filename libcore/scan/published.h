// What data sets publish about their sensors and leave out of their folders.
#pragma once

#include "scan/layout.h"

namespace quoin {

struct PublishedSensor {
    const char* name;
    Camera camera;     // colour and, as it is registered to it, depth
    double depth_unit; // metres a step
};

inline constexpr double kFrameRate = 30.0; // [1/s], of every sensor here; for layouts without time stamps

inline const PublishedSensor kKinect7Scenes{"published for 7-Scenes", {640, 480, 585.0, 585.0, 320.0, 240.0}, 0.001};
inline const PublishedSensor kIclNuim{"published for ICL-NUIM", {640, 480, 481.2, -480.0, 319.5, 239.5}, 1.0 / 5000.0};
inline const PublishedSensor kPrimeSense{"PrimeSense default", {640, 480, 525.0, 525.0, 319.5, 239.5}, 0.001};

// TUM RGB-D. fr1 and fr2 are published with k1, k2, k3, p1, p2; k1 and k2 here are the least-squares fit of two terms
// to the published radial profile over the image (RMS 1.2 px and 0.9 px; 6.1 px and 5.6 px without any). fr3 is
// undistorted.
inline const PublishedSensor kTumFreiburg1{
    "published for TUM fr1", {640, 480, 517.3, 516.5, 318.6, 255.3, 0.1166, -0.0923}, 1.0 / 5000.0};
inline const PublishedSensor kTumFreiburg2{
    "published for TUM fr2", {640, 480, 520.9, 521.0, 325.1, 249.7, 0.1210, -0.1203}, 1.0 / 5000.0};
inline const PublishedSensor kTumFreiburg3{
    "published for TUM fr3", {640, 480, 535.4, 539.2, 320.1, 247.6}, 1.0 / 5000.0};
inline const PublishedSensor kTumDefault{"TUM default", {640, 480, 525.0, 525.0, 319.5, 239.5}, 1.0 / 5000.0};

inline void apply(const PublishedSensor& sensor, Listing& listing)
{
    listing.color = sensor.camera;
    listing.depth_unit = sensor.depth_unit;
    listing.source = sensor.name;
}

} // namespace quoin
