#pragma once

#include "metrics/evaluate.h"
#include "render/textured.h"

#include <functional>

namespace quoin {

// A photograph with its depth: what a model should look like from there.
struct TargetView {
    ColorImage color;
    GrayImage gray;   // of color
    DepthImage depth; // of the depth camera; empty if the frame has none
    Camera color_camera, depth_camera;
    Rigid depth_from_color = Rigid::Identity();
};

using RenderModel = std::function<RenderedView(const Camera&, const Rigid& color_from_world)>;

// The pose near `color_from_world` from which the model looks like the photograph: Gauss-Newton on brightness (up to
// gain and bias) and on distances along the surface normal to the measured depth, both robust, coarse to fine; every
// round renders the model anew. Keeps the start when too little of the model is in view.
Rigid refine_pose(const TargetView& target, const RenderModel& render, const Rigid& color_from_world, int rounds);

} // namespace quoin
