#include "report/picture.h"

#include "mesh/plane_color.h"
#include "render/textured.h"
#include "report/draw.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace quoin {
namespace {

using Eigen::Vector3d;

constexpr int kSupersampling = 2;

struct View {
    Camera camera;
    Rigid camera_from_world = Rigid::Identity();

    Vector3d eye() const { return camera_from_world.inverse().translation(); }
};

// Scans rarely see all of the ceiling, so that the surface, looking into the room, looks up on the whole.
Vector3d guess_up(const TriangleMesh& mesh)
{
    constexpr double kLeast = 0.02; // of the area; less tells nothing
    Vector3d sum = Vector3d::Zero();
    double area = 0.0;
    for (FaceId f = 0; f < mesh.face.size(); ++f) {
        sum += area_vector(mesh, f) / 2.0;
        area += face_area(mesh, f);
    }
    return sum.norm() > kLeast * area ? Vector3d(sum.normalized()) : Vector3d(Vector3d::UnitZ());
}

// A level direction that hardly changes with `up`, from a corner of a room whose walls run along the axes.
Vector3d side_of(const Vector3d& up)
{
    constexpr double kTurn = 35.0 * std::numbers::pi / 180.0;
    Eigen::Index axis = 0;
    up.cwiseAbs().maxCoeff(&axis);
    const Eigen::Index side = (axis + 1) % 3;
    const Vector3d level = (Vector3d::Unit(side) - up[side] * up).normalized();
    return Eigen::AngleAxisd(kTurn, up) * level;
}

// From above one corner, everything in the picture.
View overview(const TriangleMesh& mesh, const PictureSize& size)
{
    const double elevation = 40.0 * std::numbers::pi / 180.0, half_angle = 22.0 * std::numbers::pi / 180.0;
    Eigen::AlignedBox3d box;
    for (const auto& face : mesh.face)
        for (const VertexId v : face)
            box.extend(mesh.position[v].cast<double>());
    const Vector3d up = guess_up(mesh), level = side_of(up);
    const Vector3d back = std::cos(elevation) * level + std::sin(elevation) * up, right = up.cross(back).normalized();
    const double radius = box.sizes().norm() / 2.0;
    Rigid world_from_camera = Rigid::Identity();
    world_from_camera.linear() << right, -back.cross(right), -back;
    world_from_camera.translation() = box.center() + back * (radius / std::sin(half_angle));
    const double focal = size.height / 2.0 / std::tan(half_angle);
    return {{size.width, size.height, focal, focal, (size.width - 1) / 2.0, (size.height - 1) / 2.0},
            world_from_camera.inverse()};
}

// Faces that look at the camera: without the others, outer walls and ceiling do not hide the room.
std::vector<FaceId> faces_towards(const TriangleMesh& mesh, const Vector3d& eye)
{
    std::vector<FaceId> faces;
    for (FaceId f = 0; f < mesh.face.size(); ++f)
        if (area_vector(mesh, f).dot(eye - corner(mesh, f, 0)) > 0.0) faces.push_back(f);
    return faces;
}

template <class T>
std::vector<T> chosen(const std::vector<T>& values, const std::vector<FaceId>& faces)
{
    std::vector<T> result;
    for (const FaceId f : faces)
        result.push_back(values[f]);
    return result;
}

ColorImage on_paper(RenderedView view)
{
    for (std::size_t i = 0; i < view.color.pixels.size(); ++i)
        if (view.face.pixels[i] == kNoFace) view.color.pixels[i] = kPaper;
    return std::move(view.color);
}

Rgb8 lit(const Rgb8& color, double cosine)
{
    const double light = 0.5 + 0.5 * std::abs(cosine);
    return {static_cast<std::uint8_t>(color[0] * light), static_cast<std::uint8_t>(color[1] * light),
            static_cast<std::uint8_t>(color[2] * light)};
}

} // namespace

ColorImage picture_of(const TriangleMesh& mesh, const PictureSize& size)
{
    const View view = overview(mesh, size);
    const TriangleMesh front{mesh.position, chosen(mesh.face, faces_towards(mesh, view.eye())), mesh.color, {}};
    return on_paper(render_colored(front, view.camera, view.camera_from_world, kSupersampling));
}

ColorImage picture_of(const PlaneMesh& mesh, const PictureSize& size)
{
    const View view = overview(mesh.mesh, size);
    TriangleMesh front; // corners of its own for every face, so that planes meet in sharp colours
    for (const FaceId f : faces_towards(mesh.mesh, view.eye())) {
        const auto first = static_cast<VertexId>(front.position.size());
        const Vector3d sight = (view.eye() - corner(mesh.mesh, f, 0)).normalized();
        const Rgb8 color = lit(plane_color(mesh.face_plane[f]), face_normal(mesh.mesh, f).dot(sight));
        for (const VertexId v : mesh.mesh.face[f])
            front.position.push_back(mesh.mesh.position[v]);
        front.color.insert(front.color.end(), 3, color);
        front.face.push_back({first, first + 1, first + 2});
    }
    return on_paper(render_colored(front, view.camera, view.camera_from_world, kSupersampling));
}

ColorImage picture_of(const TexturedMesh& mesh, const PictureSize& size)
{
    const View view = overview(mesh.planes.mesh, size);
    const auto faces = faces_towards(mesh.planes.mesh, view.eye());
    TexturedMesh front = mesh;
    front.planes.mesh.face = chosen(mesh.planes.mesh.face, faces);
    front.planes.face_plane = chosen(mesh.planes.face_plane, faces);
    front.corner_uv = chosen(mesh.corner_uv, faces);
    front.face_page = chosen(mesh.face_page, faces);
    return on_paper(render_textured(TexturedModel(front), view.camera, view.camera_from_world, kSupersampling));
}

} // namespace quoin
