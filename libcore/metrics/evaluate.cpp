#include "metrics/evaluate.h"

#include "base/error.h"
#include "mesh/hygiene.h"
#include "metrics/surface.h"
#include "metrics/texture_metrics.h"
#include "metrics/truth_metrics.h"
#include "metrics/view_metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace quoin {
namespace {

using Eigen::Vector3d;

constexpr std::array kFScoreMillimetres{5, 10, 20};

void add_size(MetricList& list, const Evaluated& inputs)
{
    if (const PlaneMesh* model = inputs.model()) {
        list.plain("size.vertices", "", static_cast<double>(model->mesh.position.size()));
        list.plain("size.faces", "", static_cast<double>(model->mesh.face.size()));
        list.plain("size.planes", "", static_cast<double>(model->plane.size()));
        if (inputs.dense && !inputs.dense->face.empty())
            list.lower("size.face_ratio", "",
                       static_cast<double>(model->mesh.face.size()) / static_cast<double>(inputs.dense->face.size()));
    }
    if (!inputs.face_filled.empty()) {
        double area = 0.0;
        for (FaceId f = 0; f < inputs.face_filled.size(); ++f)
            if (inputs.face_filled[f] != 0) area += face_area(inputs.model()->mesh, f);
        list.plain("size.filled_area", "m2", area);
    }
    if (inputs.dense) {
        list.plain("size.dense_vertices", "", static_cast<double>(inputs.dense->position.size()));
        list.plain("size.dense_faces", "", static_cast<double>(inputs.dense->face.size()));
    }
    if (!inputs.textured) return;
    double texels = 0.0, bytes = 0.0;
    for (const AtlasPage& page : inputs.textured->page) {
        texels += static_cast<double>(page.width) * page.height;
        bytes += static_cast<double>(page.image.size());
    }
    list.plain("size.pages", "", static_cast<double>(inputs.textured->page.size()));
    list.plain("size.texels", "", texels);
    list.plain("size.texture_bytes", "B", bytes);
}

void add_hygiene(MetricList& list, const PlaneMesh& model)
{
    const Hygiene h = inspect(model);
    const auto count = [&](const char* name, std::size_t value) {
        list.lower(std::string("hygiene.") + name, "", static_cast<double>(value));
    };
    count("non_manifold_edges", h.non_manifold_edges);
    count("duplicate_faces", h.duplicate_faces);
    count("bow_tie_vertices", h.bow_tie_vertices);
    count("folded_pairs", h.folded_pairs);
    count("zero_area_faces", h.zero_area_faces);
    count("slivers", h.slivers);
    count("inconsistent_edges", h.inconsistent_edges);
    count("isolated_vertices", h.isolated_vertices);
    count("flipped_faces", h.flipped_faces);
    count("disconnected_planes", h.disconnected_planes);
    count("empty_planes", h.empty_planes);
    list.plain("hygiene.components", "", static_cast<double>(h.components));
    list.lower("hygiene.border_length", "m", h.border_length);
}

std::vector<Vector3d> positions(const std::vector<SurfaceSample>& samples)
{
    std::vector<Vector3d> points;
    for (const SurfaceSample& s : samples)
        points.push_back(s.position);
    return points;
}

// What can be held against the reference: of a model that closes holes, against a dense mesh that has them, the rest.
std::vector<Vector3d> comparable(const std::vector<SurfaceSample>& samples,
                                 const std::vector<std::uint8_t>& face_filled)
{
    std::vector<Vector3d> points;
    for (const SurfaceSample& s : samples)
        if (face_filled.empty() || !face_filled[s.face]) points.push_back(s.position);
    return points;
}

// The reference of distances: the truth with the points that the scan saw, or else the dense mesh with points all over.
struct Reference {
    const TriangleMesh* mesh;
    std::vector<Vector3d> points;
};

Reference reference_of(const Evaluated& inputs, const EvaluateParams& params)
{
    if (!inputs.truth)
        return {inputs.dense, positions(sample_surface(*inputs.dense, static_cast<std::size_t>(params.samples)))};
    Reference reference{&inputs.truth->mesh, {}};
    for (const TrueSample& s : inputs.truth->sample)
        if (params.observed(s)) reference.points.push_back(s.position.cast<double>());
    return reference;
}

struct Compared {
    std::string name; // of its metrics
    const TriangleMesh& mesh;
    std::vector<std::uint8_t> face_left_out = {}; // empty: none is
};

void add_geometry(MetricList& list, const Compared& compared, const Reference& reference, const EvaluateParams& params)
{
    const auto& [name, mesh, left_out] = compared;
    const std::vector<double> there =
        distances(comparable(sample_surface(mesh, static_cast<std::size_t>(params.samples)), left_out),
                  NearestItem(*reference.mesh), params.reach);
    const std::vector<double> back = distances(reference.points, NearestItem(mesh), params.reach);
    const auto add = [&](const std::string& part, const DistanceStatistics& s) {
        list.lower(part + ".mean", "mm", s.mean * kMillimetres);
        list.lower(part + ".rms", "mm", s.rms * kMillimetres);
        list.lower(part + ".p95", "mm", s.p95 * kMillimetres);
    };
    add(name + ".accuracy", statistics(there));
    add(name + ".completeness", statistics(back));
    for (const int limit : kFScoreMillimetres) {
        const double precision = share_within(there, limit / kMillimetres),
                     recall = share_within(back, limit / kMillimetres);
        list.higher(fmt::format("{}.f_score_{}mm", name, limit), "",
                    precision + recall > 0.0 ? 2.0 * precision * recall / (precision + recall) : 0.0);
    }
}

// Moves a mesh into the world of the truth.
Rigid truth_from_mesh(const TriangleMesh& mesh, const Evaluated& inputs, const EvaluateParams& params)
{
    constexpr std::size_t enough = 20000;
    constexpr double reach = 0.1; // [m]
    if (!inputs.truth || !params.align) return Rigid::Identity();
    return register_surface(sample_surface(mesh, enough), inputs.truth->mesh, reach);
}

PlaneMesh moved(const PlaneMesh& model, const Rigid& motion)
{
    PlaneMesh result = model;
    result.mesh = moved(model.mesh, motion);
    for (Plane& plane : result.plane) {
        plane.normal = motion.linear() * plane.normal;
        plane.offset -= plane.normal.dot(motion.translation());
    }
    return result;
}

void add_surfaces(MetricList& list, const Evaluated& inputs, const EvaluateParams& params)
{
    const PlaneMesh* model = inputs.model();
    if (!inputs.truth) {
        if (model && inputs.dense)
            add_geometry(list, {"geometry", model->mesh, inputs.face_filled}, reference_of(inputs, params), params);
        return;
    }
    const Reference reference = reference_of(inputs, params);
    if (model) {
        const Rigid motion = truth_from_mesh(model->mesh, inputs, params);
        const PlaneMesh in_truth = moved(*model, motion);
        add_geometry(list, {"geometry", in_truth.mesh}, reference, params);
        list.plain(
            "geometry.moved", "mm",
            (motion * model->mesh.position.at(0).cast<double>() - model->mesh.position.at(0).cast<double>()).norm() *
                kMillimetres);
        add_plane_metrics(list, in_truth, *inputs.truth, params);
        add_crease_metrics(list, in_truth, *inputs.truth, params);
        if (inputs.textured) {
            TexturedMesh textured = *inputs.textured;
            textured.planes = in_truth;
            add_true_color_metrics(list, &textured, nullptr, *inputs.truth, params);
        }
    }
    if (inputs.dense) {
        const TriangleMesh dense = moved(*inputs.dense, truth_from_mesh(*inputs.dense, inputs, params));
        add_geometry(list, {"dense", dense}, reference, params);
        add_true_color_metrics(list, nullptr, &dense, *inputs.truth, params);
    }
}

void check(const Evaluated& inputs)
{
    if (!inputs.model() && !inputs.dense)
        throw UsageError("nothing to evaluate: give at least one of mesh, plane_mesh and textured_mesh");
    const auto refuse_empty = [](const TriangleMesh* mesh, const char* name) {
        if (mesh && mesh->face.empty()) throw InputError(fmt::format("{}: the mesh has no face to measure", name));
    };
    refuse_empty(inputs.dense, "mesh");
    refuse_empty(inputs.model() ? &inputs.model()->mesh : nullptr, inputs.textured ? "textured_mesh" : "plane_mesh");
    if (!inputs.face_filled.empty() &&
        (!inputs.model() || inputs.face_filled.size() != inputs.model()->mesh.face.size()))
        throw InputError(fmt::format("{} marks of closed holes: expected one for each face of the model",
                                     inputs.face_filled.size()));
    if (inputs.keyframes && inputs.alignment &&
        inputs.alignment->camera_from_world.size() != inputs.keyframes->frame.size())
        throw InputError(fmt::format("alignment of {} keyframes, keyframes of {}: they come from different runs",
                                     inputs.alignment->camera_from_world.size(), inputs.keyframes->frame.size()));
}

} // namespace

Metrics evaluate(const Evaluated& inputs, const EvaluateParams& params)
{
    check(inputs);
    MetricList list;
    add_size(list, inputs);
    if (inputs.model()) add_hygiene(list, *inputs.model());
    add_surfaces(list, inputs, params);
    if (inputs.truth) {
        add_pose_metrics(list, inputs);
        add_exposure_metrics(list, inputs);
    }
    if (inputs.textured) add_texture_metrics(list, inputs, params);
    add_view_metrics(list, inputs, params);
    return list.take();
}

std::string metrics_table(const Metrics& metrics)
{
    std::size_t widest = 0;
    for (const Metric& m : metrics)
        widest = std::max(widest, m.name.size());
    std::string text;
    std::string group;
    for (const Metric& m : metrics) {
        const std::string its_group = m.name.substr(0, m.name.find('.'));
        if (!group.empty() && its_group != group) text += "\n";
        group = its_group;
        const bool whole = m.value == std::floor(m.value) && std::abs(m.value) < 1e15;
        const std::string value = whole ? fmt::format("{:.0f}", m.value) : fmt::format("{:.4f}", m.value);
        const char* better = m.better == Better::Lower    ? "lower is better"
                             : m.better == Better::Higher ? "higher is better"
                                                          : "";
        std::string line = fmt::format("{:<{}}  {:>14} {:<4} {}", m.name, widest, value, m.unit, better);
        line.erase(line.find_last_not_of(' ') + 1);
        text += line + "\n";
    }
    return text;
}

} // namespace quoin
