// One function a schema; each returns lines for a person.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace quoin {

std::vector<std::string> compare_meshes(const std::filesystem::path& first, const std::filesystem::path& second);
std::vector<std::string> compare_plane_meshes(const std::filesystem::path& first, const std::filesystem::path& second);
std::vector<std::string> compare_textured_meshes(const std::filesystem::path& first,
                                                 const std::filesystem::path& second);
std::vector<std::string> compare_alignments(const std::filesystem::path& first, const std::filesystem::path& second);
std::vector<std::string> compare_scans(const std::filesystem::path& first, const std::filesystem::path& second);
std::vector<std::string> compare_keyframes(const std::filesystem::path& first, const std::filesystem::path& second);
std::vector<std::string> compare_metrics(const std::filesystem::path& first, const std::filesystem::path& second);

} // namespace quoin
