// Triangle meshes as PLY files.
#pragma once

#include "geometry/plane.h"
#include "mesh/triangle_mesh.h"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace quoin {

// Reads ascii and binary files of either byte order: positions and normals of any number type, colours of 8 or 16 bits
// or as fractions of one, under the names that common programs use. Polygons become triangles (a quad is cut along its
// shorter diagonal, others are fans); faces of fewer than three corners, unknown elements and unknown properties are
// skipped. Positions may be NaN: clean_up() drops them. Throws InputError naming file, element, row and value when the
// file is missing, truncated or malformed, an index is out of range, or there is no face element.
TriangleMesh read_ply(const std::filesystem::path& path);
// The same from a file's bytes; `name` is what messages call it.
TriangleMesh parse_ply(std::span<const std::byte> bytes, const std::string& name);

// What a file can say of every face; empty or one per face.
struct PlyFaceData {
    std::vector<Rgb8> color;
    std::vector<PlaneId> plane; // written as the int property "plane"; -1 for kNoPlane
};

// Writes a binary little-endian file, atomically. Throws ResourceError or InputError naming the path.
void write_ply(const std::filesystem::path& path, const TriangleMesh& mesh, const PlyFaceData& faces = {});

} // namespace quoin
