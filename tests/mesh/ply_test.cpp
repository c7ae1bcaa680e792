#include "mesh/ply.h"

#include "base/error.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <unistd.h>

namespace quoin {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TriangleMesh parse(const std::string& text) { return parse_ply(std::as_bytes(std::span(text)), "room.ply"); }

std::string message_of(const std::string& text)
{
    try {
        parse(text);
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

template <class T>
std::string bytes_of(T value, bool big_endian = false)
{
    std::string raw(sizeof(T), '\0');
    std::memcpy(raw.data(), &value, sizeof(T));
    return big_endian ? std::string(raw.rbegin(), raw.rend()) : raw;
}

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";
const std::string kFaces = "property list uchar int vertex_indices\n";
const std::string kTriangle =
    "ply\nformat ascii 1.0\nelement vertex 3\n" + kXyz + "element face 1\n" + kFaces + "end_header\n";

TriangleMesh coloured_triangle()
{
    TriangleMesh mesh;
    mesh.position = {{0, 0, 0}, {1.5f, 0, 0}, {0, 2, -1e-3f}};
    mesh.color = {{255, 0, 1}, {2, 254, 3}, {4, 5, 253}};
    mesh.normal = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
    mesh.face = {{0, 1, 2}};
    return mesh;
}

class TemporaryFile {
public:
    TemporaryFile() : path_(std::filesystem::temp_directory_path() / ("quoin_ply_" + std::to_string(getpid()) + ".ply"))
    {
    }
    ~TemporaryFile() { std::filesystem::remove(path_); }
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

TEST(Ply, ReadsBackWhatItWrote)
{
    const TemporaryFile file;
    const auto mesh = coloured_triangle();
    write_ply(file.path(), mesh, {{{9, 8, 7}}, {kNoPlane}});
    const auto read = read_ply(file.path());
    EXPECT_EQ(read.position, mesh.position);
    EXPECT_EQ(read.color, mesh.color);
    EXPECT_EQ(read.normal, mesh.normal);
    EXPECT_EQ(read.face, mesh.face);
}

TEST(Ply, WritesPlaneAndColourOfEveryFaceAfterItsCorners)
{
    const TemporaryFile file;
    write_ply(file.path(), coloured_triangle(), {{{9, 8, 7}}, {5}});
    std::ifstream in(file.path(), std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    EXPECT_THAT(text, HasSubstr("property uchar blue\nproperty int plane\nend_header\n"));
    EXPECT_TRUE(text.ends_with(std::string("\x09\x08\x07\x05\0\0\0", 7)));
}

TEST(Ply, ReadsAsciiWithCommentsCarriageReturnsAndUnknownParts)
{
    const auto mesh = parse(
        "ply\r\nformat ascii 1.0\r\ncomment made by hand\r\nelement camera 1\r\nproperty list uchar float view\r\n"
        "element vertex 3\r\nproperty float quality\r\nproperty double x\r\nproperty double y\r\nproperty double z\r\n"
        "element face 1\r\nproperty list uchar float texcoord\r\nproperty list uchar uint vertex_index\r\n"
        "end_header\r\n2 0.5 0.5\r\n7 0 0 0\r\n8 1e0 0 0\r\n9 0 +1 -0.25\r\n2 0 0 3 0 1 2\r\n");
    EXPECT_THAT(mesh.face, ElementsAre(Face{0, 1, 2}));
    EXPECT_EQ(mesh.position[2], Eigen::Vector3f(0, 1, -0.25f));
    EXPECT_TRUE(mesh.color.empty());
}

TEST(Ply, ReadsBothByteOrdersAlike)
{
    const auto file = [](bool big) {
        std::string text = std::string("ply\nformat binary_") + (big ? "big" : "little") +
                           "_endian 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
                           "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n"
                           "element face 1\nproperty list uchar ushort vertex_indices\nend_header\n";
        for (int v = 0; v < 3; ++v) {
            for (const double x : {0.5 + v, -1.0 * v, 3.0})
                text += bytes_of(x, big);
            text += std::string{char(v), char(10), char(200), char(255)};
        }
        text += '\3';
        for (const std::uint16_t v : {2, 1, 0})
            text += bytes_of(v, big);
        return text;
    };
    const auto little = parse(file(false)), big = parse(file(true));
    EXPECT_EQ(little.position, big.position);
    EXPECT_EQ(little.position[2], Eigen::Vector3f(2.5f, -2, 3));
    EXPECT_EQ(little.color, big.color);
    EXPECT_EQ(little.color[1], (Rgb8{1, 10, 200}));
    EXPECT_THAT(little.face, ElementsAre(Face{2, 1, 0}));
    EXPECT_EQ(big.face, little.face);
}

TEST(Ply, ScalesColoursGivenAsFractionsOrSixteenBits)
{
    const auto header = [](const std::string& type) {
        return "ply\nformat ascii 1.0\nelement vertex 3\n" + kXyz + "property " + type + " red\nproperty " + type +
               " green\nproperty " + type + " blue\nelement face 1\n" + kFaces + "end_header\n";
    };
    const auto fractions = parse(header("float") + "0 0 0 0 0.5 1\n1 0 0 2 -1 nan\n0 1 0 0 0 0\n3 0 1 2\n");
    EXPECT_EQ(fractions.color[0], (Rgb8{0, 128, 255}));
    EXPECT_EQ(fractions.color[1], (Rgb8{255, 0, 0}));
    const auto wide = parse(header("ushort") + "0 0 0 0 257 65535\n1 0 0 0 0 0\n0 1 0 0 0 0\n3 0 1 2\n");
    EXPECT_EQ(wide.color[0], (Rgb8{0, 1, 255}));
}

TEST(Ply, CutsAQuadAlongItsShorterDiagonalAndDropsAnEdge)
{
    const std::string header =
        "ply\nformat ascii 1.0\nelement vertex 4\n" + kXyz + "element face 2\n" + kFaces + "end_header\n";
    const auto mesh = parse(header + "0 0 0\n3 1 0\n4 4 0\n1 3 0\n4 0 1 2 3\n2 0 1\n");
    EXPECT_THAT(mesh.face, ElementsAre(Face{1, 2, 3}, Face{1, 3, 0}));
}

TEST(Ply, TurnsAPentagonIntoAFan)
{
    const std::string header =
        "ply\nformat ascii 1.0\nelement vertex 5\n" + kXyz + "element face 1\n" + kFaces + "end_header\n";
    const auto mesh = parse(header + "0 0 0\n1 0 0\n1 1 0\n0.5 2 0\n0 1 0\n5 0 1 2 3 4\n");
    EXPECT_THAT(mesh.face, ElementsAre(Face{0, 1, 2}, Face{0, 2, 3}, Face{0, 3, 4}));
}

TEST(Ply, KeepsPositionsThatAreNotNumbersForTheCleanUp)
{
    EXPECT_TRUE(std::isnan(parse(kTriangle + "0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n").position[0].z()));
}

TEST(Ply, OfNoFacesIsAnEmptyMesh)
{
    EXPECT_TRUE(parse("ply\nformat ascii 1.0\nelement vertex 0\n" + kXyz + "element face 0\n" + kFaces + "end_header\n")
                    .face.empty());
}

TEST(Ply, SaysWhatIsWrongWithAFileAndWhere)
{
    const std::string body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    EXPECT_THAT(message_of(""), HasSubstr("room.ply:1: the PLY header does not end"));
    EXPECT_THAT(message_of("solid cube\n"), HasSubstr("is not a PLY file"));
    EXPECT_THAT(message_of("ply\nformat ascii 1.0\n"), HasSubstr("room.ply:3: the PLY header does not end"));
    EXPECT_THAT(message_of("ply\nelement vertex 0\nend_header\n"), HasSubstr("no format line"));
    EXPECT_THAT(message_of("ply\nformat utf8 1.0\nend_header\n"),
                HasSubstr("room.ply:2: 'format utf8 1.0': expected ascii"));
    EXPECT_THAT(message_of("ply\nformat ascii 1.0\nelement vertex many\n"), HasSubstr("expected a number of rows"));
    EXPECT_THAT(message_of("ply\nformat ascii 1.0\nproperty float x\nend_header\n"),
                HasSubstr("expected format, element"));
    EXPECT_THAT(message_of("ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\n"),
                HasSubstr("expected a number type"));
    EXPECT_THAT(message_of(kTriangle + "0 0 0\n1 zero 0\n0 1 0\n3 0 1 2\n"),
                HasSubstr("'vertex', row 1 of 3: 'zero' is not a number"));
    EXPECT_THAT(message_of(kTriangle + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
                HasSubstr("face 0 names vertex 3, but there are 3"));
    EXPECT_THAT(message_of(kTriangle + "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"), HasSubstr("row 0 of 1: vertex index -1"));
    EXPECT_THAT(message_of(kTriangle + "0 0 0\n1 0 0\n0 1 0\n300 0 1\n"),
                HasSubstr("list 'vertex_indices' of 300 items"));
    EXPECT_THAT(message_of(kTriangle + body.substr(0, body.size() - 4)), HasSubstr("truncated"));
    EXPECT_THAT(message_of("ply\nformat ascii 1.0\nelement vertex 1\n" + kXyz + "end_header\n0 0 0\n"),
                HasSubstr("point cloud"));
    EXPECT_THAT(message_of("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nelement face 0\n" + kFaces +
                           "end_header\n1\n"),
                HasSubstr("no properties x, y and z"));
}

TEST(Ply, RefusesAHeaderThatPromisesMoreThanTheFileHolds)
{
    const std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000000\n" + kXyz +
                             "element face 0\n" + kFaces + "end_header\n";
    EXPECT_THAT(message_of(text),
                HasSubstr("the header promises 4000000000000 rows of 'vertex', but only 0 bytes follow"));
}

TEST(Ply, IsRefusedWhereverItIsCutOff)
{
    const TemporaryFile file;
    write_ply(file.path(), coloured_triangle());
    std::ifstream in(file.path(), std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    for (std::size_t size = 0; size < text.size(); ++size)
        EXPECT_NE(message_of(text.substr(0, size)), "no error") << size;
}

TEST(Ply, NamesAFileThatIsMissing) { EXPECT_THROW(read_ply("/nonexistent/room.ply"), InputError); }

} // namespace
} // namespace quoin
