#include "artifact/artifact.h"
#include "artifact/digest.h"
#include "base/atomic_file.h"
#include "support/expect_error.h"
#include "support/temporary_folder.h"

#include <cstring>
#include <gmock/gmock.h>

namespace quoin {
namespace {

using test::error_of;
using test::TemporaryFolder;
using ::testing::HasSubstr;

Artifact small_artifact()
{
    Artifact artifact{"mesh", 1, {}, {{"quoin.stage", "test"}}};
    artifact.add<std::uint8_t>("a_bytes", {3}, std::vector<std::uint8_t>{1, 2, 3});
    artifact.add<double>("z_numbers", {2, 1}, std::vector<double>{0.5, -2.0});
    artifact.add<float>("floats", {2}, std::vector<float>{1.0f, 2.0f});
    return artifact;
}

std::string bytes_of_small_artifact(const TemporaryFolder& folder)
{
    write_artifact(folder / "a.safetensors", small_artifact());
    return read_text(folder / "a.safetensors");
}

// What reading `bytes` as an artifact says.
std::string refusal(const TemporaryFolder& folder, const std::string& bytes)
{
    write_atomically(folder / "bad.safetensors", bytes);
    return error_of([&] { read_artifact(folder / "bad.safetensors"); }, ExitCode::Input);
}

TEST(Safetensors, WhatWasWrittenIsRead)
{
    const TemporaryFolder folder;
    write_artifact(folder / "a.safetensors", small_artifact());
    const Artifact read = read_artifact(folder / "a.safetensors");
    EXPECT_EQ(read.schema, "mesh");
    EXPECT_EQ(read.metadata.at("quoin.stage"), "test");
    ASSERT_EQ(read.tensors.size(), 3u);
    const Tensor& numbers = read.tensors.at("z_numbers");
    EXPECT_EQ(numbers.shape, (std::vector<std::size_t>{2, 1}));
    EXPECT_EQ(reinterpret_cast<const double*>(numbers.bytes.data())[1], -2.0);
    EXPECT_EQ(read.payload(), small_artifact().payload());
}

TEST(Safetensors, LargerElementsComeFirstAndDataBeginsAtA64ByteBoundary)
{
    const TemporaryFolder folder;
    const std::string bytes = bytes_of_small_artifact(folder);
    std::uint64_t length = 0;
    std::memcpy(&length, bytes.data(), 8);
    EXPECT_EQ((length + 8) % 64, 0u);
    EXPECT_EQ(file_order(small_artifact().tensors), (std::vector<std::string>{"z_numbers", "floats", "a_bytes"}));
    EXPECT_EQ(bytes.size(), 8 + length + 16 + 8 + 3);
}

TEST(Safetensors, ProvenanceDoesNotChangeThePayload)
{
    Artifact other = small_artifact();
    other.metadata["quoin.stage"] = "another";
    EXPECT_EQ(other.payload(), small_artifact().payload());
    other.add<float>("floats", {2}, std::vector<float>{1.0f, 2.5f});
    EXPECT_NE(other.payload(), small_artifact().payload());
}

TEST(Safetensors, TheHeaderAloneTellsSchemaAndPayload)
{
    const TemporaryFolder folder;
    write_artifact(folder / "a.safetensors", small_artifact());
    const ArtifactHeader header = read_artifact_header(folder / "a.safetensors");
    EXPECT_EQ(header.schema, "mesh");
    EXPECT_EQ(header.schema_version, 1);
    EXPECT_EQ(header.payload, small_artifact().payload());
}

TEST(Safetensors, EveryTruncationIsRefused)
{
    const TemporaryFolder folder;
    const std::string bytes = bytes_of_small_artifact(folder);
    for (std::size_t length = 0; length < bytes.size(); length += 7)
        EXPECT_FALSE(refusal(folder, bytes.substr(0, length)).empty());
    EXPECT_THAT(refusal(folder, bytes.substr(0, bytes.size() - 1)), HasSubstr("truncated"));
}

TEST(Safetensors, AFlippedBitNamesItsTensor)
{
    const TemporaryFolder folder;
    std::string bytes = bytes_of_small_artifact(folder);
    bytes.back() ^= 1;
    EXPECT_THAT(refusal(folder, bytes), AllOf(HasSubstr("a_bytes"), HasSubstr("damaged")));
}

TEST(Safetensors, AForeignFileIsRefused)
{
    const TemporaryFolder folder;
    EXPECT_THAT(refusal(folder, "ply\nformat ascii 1.0\n"), HasSubstr("expected a Quoin artifact"));
    EXPECT_THAT(refusal(folder, std::string("\x02\0\0\0\0\0\0\0{}", 10)), HasSubstr("without 'quoin.schema'"));
}

TEST(Safetensors, ALyingHeaderIsRefused)
{
    const TemporaryFolder folder;
    const auto with_header = [&](const std::string& header) {
        const std::uint64_t length = header.size();
        return refusal(folder, std::string(reinterpret_cast<const char*>(&length), 8) + header + "12345678");
    };
    EXPECT_THAT(with_header(R"({"a":{"dtype":"U8","shape":[9],"data_offsets":[0,8]}})"), HasSubstr("'a'"));
    EXPECT_THAT(with_header(R"({"a":{"dtype":"U8","shape":[8],"data_offsets":[0,80]}})"), HasSubstr("truncated"));
    EXPECT_THAT(with_header(R"({"a":{"dtype":"Q8","shape":[8],"data_offsets":[0,8]}})"), HasSubstr("unknown type"));
    EXPECT_THAT(with_header(R"({"a":{"dtype":"U8","shape":[4611686018427387904,4],"data_offsets":[0,8]}})"),
                HasSubstr("larger than the file"));
    EXPECT_THAT(with_header(R"({"a":{"dtype":"U8","shape":[-8],"data_offsets":[0,8]}})"), HasSubstr("malformed"));
    EXPECT_THAT(
        with_header(
            R"({"a":{"dtype":"U8","shape":[4],"data_offsets":[0,4]},"b":{"dtype":"U8","shape":[6],"data_offsets":[2,8]}})"),
        HasSubstr("overlap"));
    EXPECT_THAT(with_header("[1]"), HasSubstr("not a JSON object"));
}

TEST(Safetensors, AnotherSchemaOrANewerVersionSaysWhatToDo)
{
    const TemporaryFolder folder;
    Artifact artifact = small_artifact();
    artifact.schema_version = 7;
    write_artifact(folder / "new.safetensors", artifact);
    EXPECT_THAT(error_of([&] { read_artifact(folder / "new.safetensors", "mesh", 1); }, ExitCode::Input),
                AllOf(HasSubstr("mesh/7"), HasSubstr("mesh/1"), HasSubstr("upgrade Quoin")));
    EXPECT_THAT(error_of([&] { read_artifact(folder / "new.safetensors", "scan", 1); }, ExitCode::Input),
                HasSubstr("expected a 'scan'"));
    artifact.schema_version = 0;
    write_artifact(folder / "old.safetensors", artifact);
    EXPECT_THAT(error_of([&] { read_artifact(folder / "old.safetensors", "mesh", 1); }, ExitCode::Input),
                HasSubstr("older than this build reads"));
}

TEST(Safetensors, AMissingFileOrFolderIsNamed)
{
    const TemporaryFolder folder;
    EXPECT_THAT(error_of([&] { read_artifact(folder / "none"); }, ExitCode::Input), HasSubstr("none"));
    EXPECT_THAT(error_of([&] { read_artifact(folder.path()); }, ExitCode::Input), HasSubstr("not a regular file"));
    EXPECT_THAT(error_of([&] { write_artifact(folder / "no/such/folder", small_artifact()); }, ExitCode::Input),
                HasSubstr("no/such/folder"));
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Digest, Sha256OfAbcIsTheStandardsOwn)
{
    EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

} // namespace
} // namespace quoin
