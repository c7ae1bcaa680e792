#include "artifact/container.h"
#include "artifact/digest.h"
#include "artifact/mapped_file.h"
#include "artifact/migration.h"
#include "base/atomic_file.h"
#include "base/durable_file.h"
#include "base/error.h"
#include "base/fail_point.h"
#include "base/parallel.h"

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <optional>
#include <unistd.h>

namespace quoin {

namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;
constexpr std::uint64_t kMaxHeader = 100'000'000; // the format's own limit
constexpr std::size_t kAlignment = 64;

// The file's parts, before any tensor is looked at.
struct Parsed {
    Json header;
    std::span<const std::byte> data;
};

[[noreturn]] void refuse(const fs::path& path, const std::string& found)
{
    throw InputError(
        fmt::format("{}: {}; expected a Quoin artifact (safetensors): make it again, or check that it was copied whole",
                    path.string(), found));
}

Parsed parse_container(const fs::path& path, std::span<const std::byte> file)
{
    if (file.size() < 8) refuse(path, fmt::format("the file has {} bytes", file.size()));
    std::uint64_t length = 0;
    std::memcpy(&length, file.data(), 8);
    if (length > kMaxHeader) refuse(path, fmt::format("it begins with a header length of {}", length));
    if (length > file.size() - 8)
        refuse(path, fmt::format("truncated: the header needs {} bytes, the file has {}", length + 8, file.size()));
    const auto* text = reinterpret_cast<const char*>(file.data()) + 8;
    Parsed parsed{Json::parse(text, text + length, nullptr, false), file.subspan(8 + length)};
    if (parsed.header.is_discarded() || !parsed.header.is_object()) refuse(path, "its header is not a JSON object");
    return parsed;
}

std::map<std::string, std::string> metadata_of(const fs::path& path, const Json& header)
{
    std::map<std::string, std::string> metadata;
    const auto it = header.find("__metadata__");
    if (it == header.end()) return metadata;
    if (!it->is_object()) refuse(path, "its __metadata__ is not a JSON object");
    for (const auto& [name, value] : it->items()) {
        if (!value.is_string()) refuse(path, fmt::format("metadata '{}' is not a string", name));
        metadata[name] = value.get<std::string>();
    }
    return metadata;
}

std::optional<DType> parse_dtype(std::string_view text)
{
    for (int i = 0; i <= static_cast<int>(DType::F64); ++i)
        if (name_of(static_cast<DType>(i)) == text) return static_cast<DType>(i);
    return std::nullopt;
}

std::size_t element_count(const fs::path& path, const std::string& name, const std::vector<std::size_t>& shape,
                          std::size_t limit)
{
    std::size_t count = 1;
    for (const std::size_t n : shape) {
        if (n != 0 && count > limit / n) refuse(path, fmt::format("tensor '{}' is larger than the file", name));
        count *= n;
    }
    return count;
}

Tensor parse_tensor(const fs::path& path, const std::string& name, const Json& entry, std::span<const std::byte> data)
{
    const auto well_formed = [&] {
        if (!entry.is_object() || !entry.contains("dtype") || !entry.contains("shape") ||
            !entry.contains("data_offsets"))
            return false;
        const auto all_unsigned = [](const Json& list) {
            return list.is_array() &&
                   std::all_of(list.begin(), list.end(), [](const Json& v) { return v.is_number_unsigned(); });
        };
        return entry["dtype"].is_string() && all_unsigned(entry["shape"]) && all_unsigned(entry["data_offsets"]) &&
               entry["data_offsets"].size() == 2;
    };
    if (!well_formed()) refuse(path, fmt::format("tensor '{}' has a malformed header entry", name));
    const auto type = parse_dtype(entry["dtype"].get<std::string>());
    if (!type) refuse(path, fmt::format("tensor '{}' has the unknown type {}", name, entry["dtype"].dump()));
    const auto begin = entry["data_offsets"][0].get<std::uint64_t>(),
               end = entry["data_offsets"][1].get<std::uint64_t>();
    if (begin > end || end > data.size())
        refuse(path, fmt::format("truncated: tensor '{}' ends at byte {}, the file holds {}", name, end, data.size()));
    Tensor tensor{*type, entry["shape"].get<std::vector<std::size_t>>(), data.subspan(begin, end - begin), nullptr};
    if (element_count(path, name, tensor.shape, data.size()) * size_of(*type) != end - begin)
        refuse(path, fmt::format("tensor '{}': {} bytes do not fit its shape", name, end - begin));
    if (reinterpret_cast<std::uintptr_t>(tensor.bytes.data()) % size_of(*type) != 0)
        refuse(path, fmt::format("tensor '{}' is not aligned", name));
    return tensor;
}

void check_no_holes(const fs::path& path, const std::map<std::string, Tensor>& tensors, std::span<const std::byte> data)
{
    std::vector<std::pair<const std::byte*, const std::byte*>> ranges;
    for (const auto& [name, tensor] : tensors)
        ranges.emplace_back(tensor.bytes.data(), tensor.bytes.data() + tensor.bytes.size());
    std::ranges::sort(ranges);
    const std::byte* at = data.data();
    for (const auto& [begin, end] : ranges) {
        if (begin != at) refuse(path, "its tensors overlap or leave holes");
        at = end;
    }
    if (at != data.data() + data.size())
        refuse(path, fmt::format("{} bytes follow the last tensor", data.data() + data.size() - at));
}

std::vector<std::string> checksums(const Artifact& artifact, const std::vector<std::string>& names)
{
    std::vector<std::string> sums(names.size());
    parallel_for(names.size(), [&](std::size_t i) { sums[i] = checksum_hex(artifact.tensors.at(names[i]).bytes); });
    return sums;
}

void check_checksums(const fs::path& path, const Artifact& artifact)
{
    const auto text = artifact.metadata.find("quoin.checksums");
    if (text == artifact.metadata.end()) return; // written by a foreign program
    const Json expected = Json::parse(text->second, nullptr, false);
    const auto names = file_order(artifact.tensors);
    const auto sums = checksums(artifact, names);
    for (std::size_t i = 0; i < names.size(); ++i)
        if (!expected.is_object() || expected.value(names[i], Json()) != sums[i])
            refuse(path, fmt::format("tensor '{}' is damaged (its checksum differs)", names[i]));
}

std::string take(std::map<std::string, std::string>& metadata, const char* name)
{
    auto node = metadata.extract(name);
    return node.empty() ? std::string() : node.mapped();
}

int parse_version(const fs::path& path, const std::string& text)
{
    int version = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), version);
    if (error != std::errc() || end != text.data() + text.size())
        refuse(path, fmt::format("its schema version is '{}'", text));
    return version;
}

// Where the last tensor ends, as the header says.
std::uint64_t data_end(const Json& header)
{
    std::uint64_t end = 0;
    for (const auto& [name, entry] : header.items())
        if (name != "__metadata__" && entry.is_object() && entry.contains("data_offsets"))
            if (const Json& offsets = entry["data_offsets"]; offsets.is_array() && offsets.size() == 2)
                if (offsets[1].is_number_unsigned()) end = std::max(end, offsets[1].get<std::uint64_t>());
    return end;
}

// What the header says of the tensors' bytes.
struct Digests {
    std::string payload;
    std::vector<std::string> checksum; // of the tensors, as they are in the file
};

// As long as those of any artifact with as many tensors.
Digests blank_digests(std::size_t tensors)
{
    return {Artifact().payload(), std::vector<std::string>(tensors, checksum_hex({}))};
}

// The JSON header, padded so that the tensors behind it are aligned.
std::string header_text(const Artifact& artifact, const std::vector<std::string>& names, const Digests& digests)
{
    Json header = Json::object(), sums = Json::object();
    std::uint64_t offset = 0;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const Tensor& tensor = artifact.tensors.at(names[i]);
        header[names[i]] = {{"dtype", name_of(tensor.type)},
                            {"shape", tensor.shape},
                            {"data_offsets", {offset, offset + tensor.bytes.size()}}};
        offset += tensor.bytes.size();
        sums[names[i]] = digests.checksum[i];
    }
    Json metadata = artifact.metadata;
    metadata["quoin.schema"] = artifact.schema;
    metadata["quoin.schema_version"] = std::to_string(artifact.schema_version);
    metadata["quoin.payload"] = digests.payload;
    metadata["quoin.checksums"] = sums.dump();
    header["__metadata__"] = std::move(metadata);

    std::string text = header.dump();
    text.resize((text.size() + 8 + kAlignment - 1) / kAlignment * kAlignment - 8, ' ');
    return text;
}

void seek(int descriptor, std::size_t offset, const fs::path& path)
{
    if (::lseek(descriptor, static_cast<off_t>(offset), SEEK_SET) < 0) fail_writing(path, "cannot write", errno);
}

} // namespace

ArtifactHeader read_artifact_header(const fs::path& path)
{
    const MappedFile file(path);
    auto metadata = metadata_of(path, parse_container(path, file.bytes()).header);
    ArtifactHeader header;
    header.schema = take(metadata, "quoin.schema");
    if (header.schema.empty()) refuse(path, "a safetensors file without 'quoin.schema'");
    header.schema_version = parse_version(path, take(metadata, "quoin.schema_version"));
    header.payload = take(metadata, "quoin.payload");
    header.metadata = std::move(metadata);
    header.file_size = file.bytes().size();
    return header;
}

Artifact read_artifact(const fs::path& path)
{
    const auto file = std::make_shared<MappedFile>(path);
    const Parsed parsed = parse_container(path, file->bytes());
    Artifact artifact;
    artifact.metadata = metadata_of(path, parsed.header);
    for (const auto& [name, entry] : parsed.header.items()) {
        if (name == "__metadata__") continue;
        Tensor tensor = parse_tensor(path, name, entry, parsed.data);
        tensor.owner = file;
        artifact.tensors.emplace(name, std::move(tensor));
    }
    check_no_holes(path, artifact.tensors, parsed.data);
    artifact.schema = take(artifact.metadata, "quoin.schema");
    if (artifact.schema.empty()) refuse(path, "a safetensors file without 'quoin.schema'");
    artifact.schema_version = parse_version(path, take(artifact.metadata, "quoin.schema_version"));
    check_checksums(path, artifact);
    return artifact;
}

Artifact read_artifact(const fs::path& path, std::string_view schema, int newest)
{
    Artifact artifact = read_artifact(path);
    const auto note = [&](const char* name) {
        const auto it = artifact.metadata.find(name);
        return it == artifact.metadata.end() ? std::string("unknown") : it->second;
    };
    if (artifact.schema != schema)
        throw InputError(
            fmt::format("{}: holds a '{}' (written by {}); expected a '{}': check which output is wired here",
                        path.string(), artifact.schema, note("quoin.stage"), schema));
    if (artifact.schema_version > newest)
        throw InputError(fmt::format("{}: schema {}/{} written by {} {}; this build reads up to {}/{}: upgrade Quoin, "
                                     "or make the file again with this build",
                                     path.string(), schema, artifact.schema_version, note("quoin.stage"),
                                     note("quoin.impl_version"), schema, newest));
    return migrate(std::move(artifact), newest, path);
}

bool is_complete_artifact(const fs::path& path)
{
    try {
        const MappedFile file(path);
        const Parsed parsed = parse_container(path, file.bytes());
        return parsed.data.size() == data_end(parsed.header);
    } catch (const Error&) {
        return false;
    }
}

// Digests are found while the tensors are written; the header, whose length is known before, comes last.
std::string write_artifact_in_place(const fs::path& temporary, const Artifact& artifact, const fs::path& path)
{
    const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    if (descriptor < 0) fail_writing(path, "cannot write", errno, "name an existing folder that you may write to");
    const std::shared_ptr<const int> closer(&descriptor, [](const int* d) { ::close(*d); });
    const auto names = file_order(artifact.tensors);
    const std::uint64_t length = header_text(artifact, names, blank_digests(names.size())).size();
    seek(descriptor, sizeof(length) + length, path);
    Digests digests;
    parallel_tasks([&] { digests.payload = artifact.payload(); },
                   [&] {
                       for (const auto& name : names)
                           write_all(descriptor, artifact.tensors.at(name).bytes, path);
                       digests.checksum = checksums(artifact, names);
                   });
    fail_point("artifact_half_written", path);
    const std::string text = header_text(artifact, names, digests);
    assert(text.size() == length);
    seek(descriptor, 0, path);
    write_all(descriptor, std::as_bytes(std::span(&length, 1)), path);
    write_all(descriptor, std::as_bytes(std::span(text)), path);
    sync_file(temporary);
    return digests.payload;
}

std::string write_artifact(const fs::path& path, const Artifact& artifact)
{
    std::string payload;
    write_atomically(path,
                     [&](const fs::path& temporary) { payload = write_artifact_in_place(temporary, artifact, path); });
    return payload;
}

} // namespace quoin
