#include "base/error.h"
#include "base/parallel.h"
#include "report/draw.h"
#include "report/picture.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace quoin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr Rgb8 kOrange{255, 106, 26}, kBlue{40, 140, 255}, kInk{40, 44, 48};

std::vector<FrameId> evenly(const std::vector<FrameId>& frames, int count)
{
    const std::size_t n = std::min(frames.size(), static_cast<std::size_t>(count));
    std::vector<FrameId> chosen;
    for (std::size_t i = 0; i < n; ++i)
        chosen.push_back(frames[(2 * i + 1) * frames.size() / (2 * n)]);
    return chosen;
}

ColorImage sheet_of(const std::vector<FrameId>& frames, const ScanImages& images, const PictureSize& size)
{
    if (frames.empty()) throw ImpossibleError("there is no frame to draw");
    const Camera& camera = images.scan().color;
    const int columns = std::min(size.columns, static_cast<int>(frames.size())), width = size.width / columns;
    const int height = width * camera.height / camera.width;
    std::vector<ColorImage> pictures(frames.size());
    parallel_for(frames.size(), [&](std::size_t i) { pictures[i] = resized(images.color(frames[i]), width, height); });
    return side_by_side(pictures, columns);
}

// The photograph, its segments, and the matched borders in the pose that the scan gives.
ColorImage frame_with_lines(FrameId frame, const LineMatches& lines, const ScanImages& images)
{
    ColorImage picture = images.color(frame);
    const double width = std::max(2.0, picture.width / 320.0);
    const Camera& camera = images.scan().color;
    const Rigid camera_from_world = images.scan().color_from_world(frame);
    for (const LineMatch& line : lines) {
        if (line.frame != frame) continue;
        const Vector3d a = camera_from_world * line.end_points[0].cast<double>(),
                       b = camera_from_world * line.end_points[1].cast<double>();
        if (a.z() > 0.0 && b.z() > 0.0) draw_line(picture, camera.project(a), camera.project(b), kBlue, width / 2.0);
        draw_line(picture, line.segment.head<2>().cast<double>(), line.segment.tail<2>().cast<double>(), kOrange,
                  width);
    }
    return picture;
}

// Frames by falling number of matches.
std::vector<FrameId> frames_with_most(const LineMatches& lines, std::size_t frames, int count)
{
    std::vector<std::size_t> matches(frames, 0);
    for (const LineMatch& line : lines) {
        if (line.frame >= frames)
            throw InputError(fmt::format("a line of frame {} is not in the scan of {} frames; give the scan that the "
                                         "lines were detected in",
                                         line.frame, frames));
        ++matches[line.frame];
    }
    std::vector<FrameId> order;
    for (FrameId id = 0; id < frames; ++id)
        if (matches[id] > 0) order.push_back(id);
    std::ranges::stable_sort(order, [&](FrameId a, FrameId b) { return matches[a] > matches[b]; });
    order.resize(std::min(order.size(), static_cast<std::size_t>(count)));
    return order;
}

void draw_polyline(ColorImage& image, const std::vector<Vector2d>& points, const Rgb8& color)
{
    constexpr double kWidth = 2.5;
    for (std::size_t i = 1; i < points.size(); ++i)
        draw_line(image, points[i - 1], points[i], color, kWidth);
}

struct Frame2 { // a rectangle of the picture [px]
    double left, top, width, height;
};

void draw_energies(ColorImage& image, const Alignment& alignment, const Frame2& place)
{
    const Rgb8 colors[] = {kOrange, kBlue, {60, 160, 90}, {170, 80, 180}, {200, 160, 30}, {120, 120, 120}};
    draw_polyline(image,
                  {{place.left, place.top},
                   {place.left, place.top + place.height},
                   {place.left + place.width, place.top + place.height}},
                  kInk);
    for (std::size_t e = 0; e < alignment.energy_name.size(); ++e) {
        double most = 0.0;
        for (const auto& row : alignment.energy)
            most = std::max(most, row[e]);
        if (most == 0.0) continue;
        std::vector<Vector2d> points;
        for (std::size_t i = 0; i < alignment.energy.size(); ++i)
            points.emplace_back(place.left +
                                    place.width * static_cast<double>(i) /
                                        static_cast<double>(std::max<std::size_t>(alignment.energy.size() - 1, 1)),
                                place.top + place.height * (1.0 - alignment.energy[i][e] / most));
        draw_polyline(image, points, colors[e % std::size(colors)]);
    }
}

// Along the direction of least spread, at one scale.
void draw_path(ColorImage& image, const Alignment& alignment, const Frame2& place)
{
    std::vector<Vector3d> eyes;
    Vector3d mean = Vector3d::Zero();
    for (const Rigid& pose : alignment.camera_from_world)
        eyes.push_back(pose.inverse().translation());
    for (const auto& eye : eyes)
        mean += eye / static_cast<double>(eyes.size());
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const auto& eye : eyes)
        spread += (eye - mean) * (eye - mean).transpose();
    const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors();
    std::vector<Vector2d> flat;
    Eigen::AlignedBox2d box;
    for (const auto& eye : eyes) {
        flat.emplace_back(axes.col(2).dot(eye), axes.col(1).dot(eye));
        box.extend(flat.back());
    }
    if (flat.size() < 2) return;
    const double scale =
        std::min(place.width / std::max(box.sizes().x(), 1e-9), place.height / std::max(box.sizes().y(), 1e-9));
    for (auto& p : flat)
        p = Vector2d(place.left, place.top) + Vector2d(place.width, place.height) / 2.0 + (p - box.center()) * scale;
    draw_polyline(image, flat, kBlue);
}

} // namespace

ColorImage picture_of(const Scan& scan, const ScanImages& images, const PictureSize& size)
{
    return sheet_of(evenly(scan.frames_in_use(), size.photographs), images, size);
}

ColorImage picture_of(const Keyframes& keyframes, const ScanImages& images, const PictureSize& size)
{
    for (const FrameId id : keyframes.frame)
        if (id >= images.scan().frames.size())
            throw InputError(
                fmt::format("keyframe {} is not in the scan of {} frames", id, images.scan().frames.size()));
    return sheet_of(evenly(keyframes.frame, size.photographs), images, size);
}

ColorImage picture_of(const LineMatches& lines, const ScanImages& images, const PictureSize& size)
{
    constexpr int kFrames = 4, kColumns = 2;
    const auto frames = frames_with_most(lines, images.scan().frames.size(), kFrames);
    if (frames.empty()) throw ImpossibleError("the artifact holds no line to draw");
    std::vector<ColorImage> pictures(frames.size());
    const int width = size.width / kColumns;
    parallel_for(frames.size(), [&](std::size_t i) {
        const ColorImage picture = frame_with_lines(frames[i], lines, images);
        pictures[i] = picture.width > width ? resized(picture, width, width * picture.height / picture.width) : picture;
    });
    return side_by_side(pictures, kColumns);
}

ColorImage picture_of(const Alignment& alignment, const PictureSize& size)
{
    ColorImage image(size.width, size.height, kPaper);
    const double margin = size.width / 24.0, half = size.height / 2.0;
    if (!alignment.energy.empty())
        draw_energies(image, alignment, {margin, margin, size.width - 2.0 * margin, half - 1.5 * margin});
    if (!alignment.camera_from_world.empty())
        draw_path(image, alignment, {margin, half + margin / 2.0, size.width - 2.0 * margin, half - 1.5 * margin});
    return image;
}

} // namespace quoin
