// Rigid transforms, cameras and planes as tensors: transforms row major (4,4).
#pragma once

#include "geometry/camera.h"
#include "geometry/plane.h"
#include "geometry/rigid.h"
#include "schema/tensor_io.h"

#include <vector>

namespace quoin {

void add_transforms(Artifact& artifact, const std::string& name, const std::vector<Rigid>& transforms); // (n,4,4) f64
std::vector<Rigid> read_transforms(const TensorReader& reader, const std::string& name);
void add_transform(Artifact& artifact, const std::string& name, const Rigid& transform); // (4,4) f64
Rigid read_transform(const TensorReader& reader, const std::string& name);
void add_camera(Artifact& artifact, const std::string& name,
                const Camera& camera); // (8) f64: width height fx fy cx cy k1 k2
Camera read_camera(const TensorReader& reader, const std::string& name);
void add_planes(Artifact& artifact, const std::string& name,
                const std::vector<Plane>& planes); // (n,4) f64: normal, offset
std::vector<Plane> read_planes(const TensorReader& reader, const std::string& name);

} // namespace quoin
