// The tensors that mesh, plane_mesh and textured_mesh share.
#pragma once

#include "mesh/plane_mesh.h"
#include "schema/tensor_io.h"

namespace quoin {

void add_mesh_tensors(Artifact& artifact, TriangleMesh mesh);
TriangleMesh read_mesh_tensors(const TensorReader& reader);
void add_plane_mesh_tensors(Artifact& artifact, PlaneMesh mesh);
PlaneMesh read_plane_mesh_tensors(const TensorReader& reader);

} // namespace quoin
