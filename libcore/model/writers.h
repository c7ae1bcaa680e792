// One writer per file format.
#pragma once

#include "model/model.h"
#include "model/primitives.h"

#include <filesystem>
#include <vector>

namespace quoin {

// Binary glTF 2.0 with the pages inside: core and KHR_materials_unlit only, one primitive and one material a page.
void write_glb(const Model& model, const std::vector<Primitive>& primitives, const std::filesystem::path& path);
// OBJ, and beside it an MTL with paths relative to it. Without texture, colours follow the positions ("v x y z r g b").
void write_obj(const Model& model, const std::vector<Primitive>& primitives, const std::filesystem::path& path);
// Planes with equation, area, orientation and colour.
void write_planes(const Model& model, const std::filesystem::path& path);
// "time tx ty tz qx qy qz qw" per camera, camera to model.
void write_trajectory(const Model& model, const std::filesystem::path& path);
// Counts, sizes, the frame and the files that stand in `folder` by now.
void write_summary(const Model& model, const std::filesystem::path& folder, const std::filesystem::path& path);

} // namespace quoin
