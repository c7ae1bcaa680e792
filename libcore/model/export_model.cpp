#include "model/export_model.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "mesh/plane_color.h"
#include "mesh/ply.h"
#include "model/leveling.h"
#include "model/writers.h"

#include <array>
#include <cmath>
#include <fmt/format.h>

namespace quoin {
namespace {

const PlaneMesh* plane_mesh_of(const ModelParts& parts)
{
    return parts.textured ? &parts.textured->planes : parts.planes;
}

const TriangleMesh& mesh_of(const ModelParts& parts)
{
    const PlaneMesh* planes = plane_mesh_of(parts);
    const TriangleMesh* mesh = planes ? &planes->mesh : parts.mesh;
    if (mesh == nullptr) throw UsageError("there is nothing to export; give a textured_mesh, a plane_mesh or a mesh");
    if (mesh->face.empty()) throw ImpossibleError("the mesh to export has no faces");
    return *mesh;
}

struct WorldPose {
    double time = 0.0;
    Rigid camera_from_world = Rigid::Identity();
};

void check_keyframes(const ModelParts& parts)
{
    if (!parts.scan || !parts.keyframes) return;
    for (const FrameId id : parts.keyframes->frame)
        if (id >= parts.scan->frames.size())
            throw InputError(
                fmt::format("keyframe {} is not in the scan of {} frames; give the artifacts of one pipeline run", id,
                            parts.scan->frames.size()));
    if (parts.alignment && parts.alignment->camera_from_world.size() != parts.keyframes->frame.size())
        throw InputError(
            fmt::format("the alignment has {} poses for {} keyframes; give the artifacts of one pipeline run",
                        parts.alignment->camera_from_world.size(), parts.keyframes->frame.size()));
}

// The refined poses of the keyframes, else those of the frames in use; without a scan, a pose's number is its time.
std::vector<WorldPose> poses_of(const ModelParts& parts)
{
    check_keyframes(parts);
    std::vector<WorldPose> poses;
    if (parts.alignment) {
        for (std::size_t k = 0; k < parts.alignment->camera_from_world.size(); ++k) {
            const bool timed = parts.scan && parts.keyframes;
            poses.push_back({timed ? parts.scan->frames[parts.keyframes->frame[k]].time : static_cast<double>(k),
                             parts.alignment->camera_from_world[k]});
        }
    } else if (parts.scan) {
        for (const FrameId id : parts.scan->frames_in_use())
            poses.push_back({parts.scan->frames[id].time, parts.scan->frames[id].camera_from_world});
    }
    return poses;
}

std::vector<ModelPage> pages_of(const TexturedMesh& textured)
{
    std::vector<ModelPage> pages;
    for (const auto& page : textured.page) {
        const bool jpeg = page.image.size() > 1 && page.image[0] == std::byte{0xff} && page.image[1] == std::byte{0xd8};
        pages.push_back(
            {fmt::format("model_{}.{}", pages.size(), jpeg ? "jpg" : "png"), jpeg ? "image/jpeg" : "image/png", &page});
    }
    return pages;
}

// w' = w - n' . t for p' = R p + t.
Plane transformed(const Plane& plane, const Rigid& to_from)
{
    const Eigen::Vector3d normal = to_from.linear() * plane.normal;
    return {normal, plane.offset - normal.dot(to_from.translation())};
}

void move_to_model_frame(const ModelParts& parts, Model& model)
{
    const PlaneMesh* planes = plane_mesh_of(parts);
    for (auto& p : model.mesh.position)
        p = (model.model_from_world * p.cast<double>()).cast<float>();
    for (auto& n : model.mesh.normal)
        n = (model.model_from_world.linear() * n.cast<double>()).cast<float>();
    if (planes)
        for (const auto& plane : planes->plane)
            model.plane.push_back(transformed(plane, model.model_from_world));
    for (const auto& pose : poses_of(parts))
        model.trajectory.push_back({pose.time, model.model_from_world * pose.camera_from_world.inverse()});
}

Model make_model(const ModelParts& parts, const ExportParams& params)
{
    Model model;
    model.mesh = mesh_of(parts);
    model.generator = parts.version.empty() ? "Quoin" : "Quoin " + parts.version;
    const PlaneMesh* planes = plane_mesh_of(parts);
    if (planes) model.face_plane = planes->face_plane;
    if (planes)
        for (PlaneId p = 0; p < planes->plane.size(); ++p)
            model.plane_color.push_back(plane_color(p));
    if (parts.textured) {
        model.texture = parts.textured;
        model.page = pages_of(*parts.textured);
    }
    std::vector<Rigid> camera_from_world;
    for (const auto& pose : poses_of(parts))
        camera_from_world.push_back(pose.camera_from_world);
    if (params.level && !camera_from_world.empty()) {
        const Leveling level = find_level(model.mesh, planes, camera_from_world, params);
        model.model_from_world = level.model_from_world;
        model.floor = level.floor;
        model.levelled = true;
    }
    move_to_model_frame(parts, model);
    return model;
}

PlyFaceData face_data(const Model& model)
{
    PlyFaceData faces;
    faces.plane = model.face_plane;
    for (const PlaneId p : model.face_plane)
        faces.color.push_back(model.plane_color[p]);
    return faces;
}

} // namespace

void export_model(const ModelParts& parts, const std::filesystem::path& folder, const ExportParams& params)
{
    const Model model = make_model(parts, params);
    const auto primitives = make_primitives(model, params.normals);
    for (const auto& page : model.page)
        write_atomically(folder / page.file, std::span<const std::byte>(page.page->image));
    if (params.glb) write_glb(model, primitives, folder / "model.glb");
    if (params.obj) write_obj(model, primitives, folder / "model.obj");
    if (params.ply) write_ply(folder / "model.ply", model.mesh, face_data(model));
    if (model.has_planes()) write_planes(model, folder / "planes.json");
    if (!model.trajectory.empty()) write_trajectory(model, folder / "trajectory.txt");
    write_summary(model, folder, folder / "summary.json");
}

} // namespace quoin
