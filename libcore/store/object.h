// Objects as they lie on disk: how large, how whole, and how they are shown elsewhere.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace quoin {

// Bytes of a file, or of all files of a folder; none when it is missing.
std::optional<std::uint64_t> object_size(const std::filesystem::path& object);

// What is wrong with the object of this payload, every byte of it read: "" when nothing is.
std::string object_damage(const std::filesystem::path& object, const std::string& payload);

// Renames unless `place` exists. False when it does.
bool rename_no_replace(const std::filesystem::path& from, const std::filesystem::path& place);

// `place` shows the object: it is the same file, or the folder has the same files but those called `rewritten`.
bool shows_object(const std::filesystem::path& object, const std::filesystem::path& place,
                  const std::vector<std::string>& rewritten);

// Puts the object at `place`, replacing what is there. Temporaries are made beside `temporary`, on the store's file
// system, where it is writable.
void show_file(const std::filesystem::path& object, const std::filesystem::path& place,
               const std::filesystem::path& temporary);
void show_folder(const std::filesystem::path& object, const std::filesystem::path& place);

} // namespace quoin
