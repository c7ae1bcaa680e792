#include "simplify/knots.h"

#include "mesh/adjacency.h"
#include "simplify/zero_area.h"

#include <algorithm>

namespace quoin {
namespace {

// Of every face the piece that it belongs to.
std::vector<std::uint32_t> pieces_of(const std::vector<Face>& faces, std::size_t vertices)
{
    TriangleMesh mesh;
    mesh.position.resize(vertices);
    mesh.face = faces;
    return face_components(mesh);
}

// Points where some of the segments meet others.
std::vector<std::uint32_t> ends_of(const std::vector<std::uint32_t>& segments, const Outline& outline)
{
    std::vector<std::uint8_t> chosen(outline.segment.size(), 0);
    for (const std::uint32_t s : segments)
        chosen[s] = 1;
    std::vector<std::array<std::uint8_t, 2>> meets(outline.point.size(), {0, 0}); // others, chosen ones
    for (std::size_t s = 0; s < chosen.size(); ++s)
        for (const std::uint32_t p : outline.segment[s])
            meets[p][chosen[s]] = 1;
    std::vector<std::uint32_t> ends;
    for (std::uint32_t p = 0; p < meets.size(); ++p)
        if (meets[p][0] && meets[p][1]) ends.push_back(p);
    return ends;
}

} // namespace

std::vector<std::uint32_t> segments_aside(const Outline& outline, const std::vector<Face>& faces)
{
    const auto piece = pieces_of(faces, outline.point.size());
    std::vector<std::size_t> size;
    for (const std::uint32_t p : piece) {
        size.resize(std::max<std::size_t>(size.size(), p + 1), 0);
        ++size[p];
    }
    const auto main = static_cast<std::uint32_t>(std::max_element(size.begin(), size.end()) - size.begin());
    std::vector<std::array<std::uint32_t, 2>> aside; // half-edges
    for (std::size_t f = 0; f < faces.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k)
            if (piece[f] != main) aside.push_back({faces[f][k], faces[f][(k + 1) % 3]});
    std::sort(aside.begin(), aside.end());
    std::vector<std::uint32_t> found;
    for (std::uint32_t s = 0; s < outline.segment.size(); ++s)
        if (std::binary_search(aside.begin(), aside.end(), outline.segment[s])) found.push_back(s);
    return found;
}

std::vector<std::uint32_t> segments_without_room(const PlaneOutline& plane,
                                                 const std::vector<Eigen::Vector3d>& position,
                                                 const std::vector<Face>& faces)
{
    std::vector<std::array<std::uint32_t, 2>> edges; // of faces without area, both ways
    std::vector<std::uint32_t> apexes;               // opposite their longest edges
    for (const Face& face : faces) {
        Triangle t;
        for (std::size_t k = 0; k < 3; ++k)
            t[k] = position[plane.vertex[face[k]]].cast<float>().cast<double>(); // as it is written
        if (has_area(t)) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = face[k], b = face[(k + 1) % 3];
            edges.insert(edges.end(), {{a, b}, {b, a}});
            if ((t[(k + 1) % 3] - t[k]).norm() == longest_edge(t)) apexes.push_back(face[(k + 2) % 3]);
        }
    }
    const auto contains = [](const auto& list, const auto& item) {
        return std::ranges::find(list, item) != list.end();
    };
    std::vector<std::uint32_t> found;
    for (std::uint32_t s = 0; s < plane.outline.segment.size() && !edges.empty(); ++s) {
        const auto& segment = plane.outline.segment[s];
        if (contains(edges, segment) || contains(apexes, segment[0]) || contains(apexes, segment[1]))
            found.push_back(s);
    }
    return found;
}

std::vector<Eigen::Vector3d> find_knots(const PlaneOutline& plane, const std::vector<Eigen::Vector3d>& position,
                                        const std::vector<std::uint32_t>& spoilt)
{
    std::vector<Eigen::Vector3d> knots;
    const auto on_segment = [&](std::uint32_t i, double t) {
        const auto [a, b] = plane.outline.segment[i];
        return Eigen::Vector3d((1.0 - t) * position[plane.vertex[a]] + t * position[plane.vertex[b]]);
    };
    for (const auto& [i, j] : crossings(plane.outline))
        knots.push_back(on_segment(i, crossing_parameter(plane.outline, i, j)));
    if (!knots.empty()) return knots;
    const auto bad = spoilt.empty() ? contradictions(plane.outline) : spoilt;
    for (const std::uint32_t p : ends_of(bad, plane.outline))
        knots.push_back(position[plane.vertex[p]]);
    if (!knots.empty()) return knots;
    for (const std::uint32_t i : bad)
        for (const double t : {0.0, 0.5, 1.0})
            knots.push_back(on_segment(i, t));
    return knots;
}

} // namespace quoin
