#include "fill/trim.h"

#include "geometry/union_find.h"
#include "mesh/adjacency.h"
#include "mesh/cleanup.h"
#include "mesh/hygiene.h"
#include "mesh/plane_parts.h"

#include <algorithm>
#include <map>
#include <optional>

namespace quoin {
namespace {

void join(UnionFind& sets, std::uint32_t a, std::uint32_t b)
{
    const std::uint32_t r = sets.find(a), s = sets.find(b);
    if (r != s) sets.join(std::min(r, s), std::max(r, s));
}

// One look at the whole mesh.
class PatchTrimmer {
public:
    PatchTrimmer(PlaneMesh& mesh, FaceId first, double distance)
        : mesh_(mesh), first_(first), distance_(distance), opposite_(opposite_half_edges(mesh.mesh)),
          bad_(mesh.mesh.face.size(), 0)
    {
    }

    // Were there faces to take out?
    bool run()
    {
        find_away();
        find_folded();
        if (!any()) place_strangers();
        remove_bad();
        return any();
    }

private:
    bool is_new(FaceId f) const { return f >= first_; }
    bool any() const { return std::ranges::count(bad_, 1) > 0; }
    void find_away();
    void find_folded();
    void place_strangers();
    void remove_bad();

    PlaneMesh& mesh_;
    const FaceId first_;
    const double distance_;
    const std::vector<std::uint32_t> opposite_;
    std::vector<std::uint8_t> bad_; // F
};

void PatchTrimmer::find_away()
{
    for (FaceId f = first_; f < bad_.size(); ++f)
        if (face_normal(mesh_.mesh, f).dot(mesh_.plane[mesh_.face_plane[f]].normal) < 0.0) bad_[f] = 1;
}

void PatchTrimmer::find_folded()
{
    const double folded_cosine = HygieneLimits{}.folded_cosine;
    for (std::uint32_t h = 3 * first_; h < opposite_.size(); ++h) {
        if (!is_half_edge(opposite_[h])) continue;
        const FaceId f = h / 3, g = opposite_[h] / 3;
        if (face_normal(mesh_.mesh, f).dot(face_normal(mesh_.mesh, g)) >= folded_cosine) continue;
        const bool smaller = std::pair(face_area(mesh_.mesh, f), f) < std::pair(face_area(mesh_.mesh, g), g);
        if (!is_new(g) || smaller) bad_[f] = 1;
    }
}

void PatchTrimmer::place_strangers()
{
    UnionFind parts(bad_.size());
    for (std::uint32_t h = 0; h < opposite_.size(); ++h)
        if (is_half_edge(opposite_[h]) && mesh_.face_plane[h / 3] == mesh_.face_plane[opposite_[h] / 3])
            join(parts, h / 3, opposite_[h] / 3);
    std::map<FaceId, std::vector<FaceId>> strangers; // by root; old faces, which come first, are the roots of theirs
    for (FaceId f = first_; f < bad_.size(); ++f)
        if (is_new(parts.find(f))) strangers[parts.find(f)].push_back(f);
    const auto old_plane = [&](FaceId f) { return is_new(f) ? std::nullopt : std::optional(mesh_.face_plane[f]); };
    for (const auto& [_, part] : strangers) {
        const auto plane = plane_beside(mesh_, opposite_, part, distance_, old_plane);
        for (const FaceId f : part)
            plane ? mesh_.face_plane[f] = *plane : bad_[f] = 1;
    }
}

void PatchTrimmer::remove_bad()
{
    FaceId count = first_;
    for (FaceId f = first_; f < bad_.size(); ++f) {
        if (bad_[f] != 0) continue;
        mesh_.mesh.face[count] = mesh_.mesh.face[f];
        mesh_.face_plane[count++] = mesh_.face_plane[f];
    }
    mesh_.mesh.face.resize(count);
    mesh_.face_plane.resize(count);
}

} // namespace

void trim_patches(PlaneMesh& mesh, FaceId first, double distance)
{
    while (PatchTrimmer(mesh, first, distance).run())
        ;
    split_touching_fans(mesh.mesh);
    remove_isolated_vertices(mesh.mesh);
}

} // namespace quoin
