// Which keyframe sees which texel, and which depths lie on which plane. Lists are made once and kept while the energy
// is minimised, so that it always sums the same set.
#pragma once

#include "alignment/samples.h"
#include "alignment/scene.h"

#include <vector>

namespace quoin {

// Pairs of texel and frame; those of frame k are first_of_frame[k] .. first_of_frame[k+1]-1, by ascending texel.
struct Observations {
    std::vector<std::uint32_t> first_of_frame; // K + 1
    std::vector<TexelId> texel;                // O
    std::vector<std::uint32_t> frame;          // O
    std::vector<std::uint32_t> first_of_texel; // T + 1
    std::vector<std::uint32_t> of_texel;       // O, observations sorted by texel

    std::size_t size() const { return texel.size(); }
    std::uint32_t views(TexelId t) const { return first_of_texel[t + 1] - first_of_texel[t]; }
};

// Consecutive observations, or depths, of one frame on one plane.
struct ObservationRun {
    std::uint32_t frame = 0, begin = 0, end = 0;
    PlaneId plane = kNoPlane;
};

// A measured depth that lies on a plane of the mesh.
struct DepthSample {
    Eigen::Vector3f p_camera; // depth camera [m]
    PlaneId plane = kNoPlane;
    float inverse_sigma = 1.0f; // [1/m]
};
struct DepthSamples {
    std::vector<ObservationRun> run;  // by frame, then plane
    std::vector<float> x, y, z;       // of every sample: p_camera
    std::vector<float> inverse_sigma; // [1/m]

    std::size_t size() const { return x.size(); }
    void add(std::uint32_t frame, std::vector<DepthSample> samples); // frames ascending
};

// Texels that a frame's colour camera sees at a pyramid level: inside image and depth range, facing the camera, nearest
// in the rendered mesh, in accord with the measured depth where there is one, away from edges of both depths, not
// saturated. Only texels seen by two frames or more are kept: one view alone says nothing about its pose.
Observations observe(const AlignmentScene& scene, const AlignmentState& state, const Texels& texels, int level);

// Every depth_stride-th depth that agrees with the rendered mesh.
DepthSamples sample_depths(const AlignmentScene& scene, const AlignmentState& state);

// What is in both lists, of the same texels; of texels that two frames or more still see.
Observations in_both(const Observations& a, const Observations& b);

// Observations of the texels that `keep` marks, renumbered as kept() renumbers the texels.
Observations kept(const Observations& observations, const std::vector<std::uint8_t>& keep);

} // namespace quoin
