#include "lines/segments.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/ximgproc/edge_drawing.hpp>

namespace quoin {
namespace {

constexpr double kReferenceWidth = 640.0; // [px], of DetectLinesParams::min_segment

cv::Mat to_bytes(const GrayImage& image)
{
    cv::Mat bytes(image.height, image.width, CV_8U);
    for (int y = 0; y < image.height; ++y)
        std::transform(image.row(y), image.row(y) + image.width, bytes.ptr<std::uint8_t>(y),
                       [](float value) { return cv::saturate_cast<std::uint8_t>(255.0f * value); });
    return bytes;
}

std::vector<cv::Vec4f> run_lsd(const cv::Mat& image, const DetectLinesParams& params)
{
    constexpr double kLogEps = 0.0; // used by LSD_REFINE_ADV only
    const auto detector =
        cv::createLineSegmentDetector(cv::LSD_REFINE_STD, params.lsd_scale, params.lsd_sigma, params.lsd_quantization,
                                      params.lsd_angle, kLogEps, params.lsd_density, params.lsd_bins);
    std::vector<cv::Vec4f> lines;
    detector->detect(image, lines);
    return lines;
}

std::vector<cv::Vec4f> run_edlines(const cv::Mat& image, const DetectLinesParams& params, double min_length)
{
    const auto detector = cv::ximgproc::createEdgeDrawing();
    detector->params.GradientThresholdValue = params.edlines_gradient;
    detector->params.Sigma = static_cast<float>(params.edlines_sigma);
    detector->params.LineFitErrorThreshold = params.edlines_fit_error;
    detector->params.MinLineLength = static_cast<int>(min_length);
    detector->detectEdges(image);
    std::vector<cv::Vec4f> lines;
    detector->detectLines(lines);
    return lines;
}

} // namespace

double min_segment_length(const GrayImage& image, const DetectLinesParams& params)
{
    return params.min_segment * std::sqrt(image.width / kReferenceWidth);
}

std::vector<Segment> detect_segments(const GrayImage& image, const DetectLinesParams& params)
{
    const double min_length = min_segment_length(image, params);
    const cv::Mat bytes = to_bytes(image);
    const auto lines =
        params.method == SegmentMethod::Lsd ? run_lsd(bytes, params) : run_edlines(bytes, params, min_length);
    std::vector<Segment> segments;
    for (const auto& line : lines) {
        const Segment segment{{line[0], line[1]}, {line[2], line[3]}};
        if (segment.length() >= min_length) segments.push_back(segment);
    }
    return segments;
}

} // namespace quoin
