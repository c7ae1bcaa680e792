// Pictures and words, drawn with OpenCV's strokes.
#include "synth/material.h"
#include "synth/random.h"

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>

namespace quoin {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_DUPLEX;
constexpr std::array kWords{"QUOIN",  "CORNER",  "STONE", "PLANE", "CREASE", "ATLAS",  "MUSEUM",  "CONCERT", "HARBOUR",
                            "SUMMER", "LIBRARY", "NORTH", "RIVER", "GARDEN", "WINTER", "EXPO 71", "BAUHAUS", "ORCHARD"};

cv::Scalar any_color(CounterRandom& random, double low, double high)
{
    return {random.uniform(low, high), random.uniform(low, high), random.uniform(low, high)};
}

// Text inside a rectangle, as large as fits.
void fit_text(cv::Mat& image, const std::string& text, const cv::Rect& box, const cv::Scalar& ink)
{
    int baseline = 0;
    const cv::Size unit = cv::getTextSize(text, kFont, 1.0, 1, &baseline);
    const double scale =
        std::min(box.width / static_cast<double>(unit.width), box.height / static_cast<double>(unit.height + baseline));
    const int thickness = std::max(1, static_cast<int>(scale * 1.6));
    const cv::Size size = cv::getTextSize(text, kFont, scale, thickness, &baseline);
    const cv::Point origin(box.x + (box.width - size.width) / 2, box.y + (box.height + size.height) / 2);
    cv::putText(image, text, origin, kFont, scale, ink, thickness, cv::LINE_AA);
}

cv::Rect part(const cv::Mat& image, double x, double y, double width, double height)
{
    return {static_cast<int>(x * image.cols), static_cast<int>(y * image.rows), static_cast<int>(width * image.cols),
            static_cast<int>(height * image.rows)};
}

std::string word(CounterRandom& random) { return kWords[random.below(kWords.size())]; }

void draw_headline(cv::Mat& image, CounterRandom& random)
{
    image = any_color(random, 150, 235);
    const cv::Scalar ink = any_color(random, 10, 90), accent = any_color(random, 40, 220);
    cv::circle(image, {image.cols / 2, image.rows * 45 / 100}, std::min(image.cols, image.rows) * 30 / 100, accent,
               cv::FILLED, cv::LINE_AA);
    for (int i = 0; i < 9; ++i) {
        const cv::Rect box = part(image, 0.1 + 0.09 * i, 0.32 + 0.03 * (i % 3), 0.05, 0.30 - 0.06 * (i % 2));
        cv::rectangle(image, box, i % 2 ? ink : any_color(random, 60, 240), cv::FILLED);
    }
    fit_text(image, word(random), part(image, 0.06, 0.03, 0.88, 0.20), ink);
    fit_text(image, word(random) + " " + word(random), part(image, 0.10, 0.74, 0.80, 0.10), ink);
    fit_text(image, "12 MAY - 30 JULY", part(image, 0.15, 0.86, 0.70, 0.08), accent * 0.5);
}

void draw_eye_chart(cv::Mat& image, CounterRandom& random)
{
    image = cv::Scalar(228, 228, 222);
    double y = 0.03;
    for (int row = 0; row < 7; ++row) {
        std::string letters;
        for (int i = 0; i <= row; ++i)
            letters += std::string(i ? " " : "") + "CDEFLOPTZ"[random.below(9)];
        const double height = 0.24 * std::pow(0.74, row);
        fit_text(image, letters, part(image, 0.06, y, 0.88, height), {25, 25, 25});
        y += height * 1.12;
    }
    cv::line(image, {image.cols / 10, image.rows * 97 / 100}, {image.cols * 9 / 10, image.rows * 97 / 100},
             {30, 30, 190}, 3, cv::LINE_AA);
}

void draw_newspaper(cv::Mat& image, CounterRandom& random)
{
    image = cv::Scalar(222, 217, 204);
    const cv::Scalar ink(35, 35, 40);
    fit_text(image, "THE DAILY " + word(random), part(image, 0.05, 0.02, 0.90, 0.14), ink);
    cv::line(image, {image.cols / 20, image.rows * 17 / 100}, {image.cols * 19 / 20, image.rows * 17 / 100}, ink, 2,
             cv::LINE_AA);
    cv::rectangle(image, part(image, 0.36, 0.22, 0.58, 0.30), any_color(random, 80, 180), cv::FILLED);
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 18; ++row) {
            const double x = 0.05 + 0.31 * column, y = 0.21 + 0.042 * row;
            if (column > 0 && y < 0.54) continue;
            fit_text(image, word(random) + " " + word(random), part(image, x, y, 0.28, 0.036), ink);
        }
}

void draw_painting(cv::Mat& image, CounterRandom& random)
{
    image = any_color(random, 120, 210);
    for (int i = 0; i < 160; ++i) {
        const cv::Point centre(static_cast<int>(random.uniform() * image.cols),
                               static_cast<int>(random.uniform() * image.rows));
        const double reach = random.uniform(0.01, 0.12) * image.cols;
        const cv::Size axes(static_cast<int>(reach) + 2, static_cast<int>(reach * random.uniform(0.2, 1.0)) + 2);
        const int thickness = random.uniform() < 0.5 ? cv::FILLED : 3;
        cv::ellipse(image, centre, axes, random.uniform(0.0, 180.0), 0.0, 360.0, any_color(random, 20, 235), thickness,
                    cv::LINE_AA);
    }
    const int border = std::max(6, image.cols / 25);
    cv::rectangle(image, {0, 0, image.cols, image.rows}, {40, 55, 75}, 2 * border);
    cv::rectangle(image, {border, border, image.cols - 2 * border, image.rows - 2 * border}, {190, 200, 205}, 2);
}

void draw_chart(cv::Mat& image, CounterRandom& random)
{
    image = cv::Scalar(215, 222, 225);
    constexpr int columns = 8, rows = 6;
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) {
            const cv::Rect cell = part(image, 0.06 + 0.11 * c, 0.20 + 0.125 * r, 0.10, 0.115);
            const bool dark = (r + c) % 2;
            cv::rectangle(image, cell, dark ? cv::Scalar(45, 45, 45) : any_color(random, 60, 230), cv::FILLED);
            fit_text(image, std::to_string(r * columns + c), cell,
                     dark ? cv::Scalar(225, 225, 225) : cv::Scalar(20, 20, 20));
        }
    fit_text(image, "CHART No. " + std::to_string(1 + random.below(99)), part(image, 0.06, 0.04, 0.88, 0.12),
             {40, 30, 30});
}

ColorImage to_color_image(const cv::Mat& rgb)
{
    ColorImage image(rgb.cols, rgb.rows);
    for (int y = 0; y < rgb.rows; ++y)
        for (int x = 0; x < rgb.cols; ++x) {
            const auto& p = rgb.at<cv::Vec3b>(y, x);
            image.at(x, y) = {p[0], p[1], p[2]};
        }
    return image;
}

cv::Mat canvas(const Eigen::Vector2d& size, double pixel)
{
    return cv::Mat(std::max(8, static_cast<int>(size.y() / pixel + 0.5)),
                   std::max(8, static_cast<int>(size.x() / pixel + 0.5)), CV_8UC3);
}

} // namespace

ColorImage draw_poster(PosterStyle style, const Eigen::Vector2d& size, double pixel, std::uint32_t seed)
{
    CounterRandom random(seed, RandomPurpose::Style, 1);
    cv::Mat image = canvas(size, pixel);
    switch (style) {
    case PosterStyle::Headline:
        draw_headline(image, random);
        break;
    case PosterStyle::EyeChart:
        draw_eye_chart(image, random);
        break;
    case PosterStyle::Newspaper:
        draw_newspaper(image, random);
        break;
    case PosterStyle::Painting:
        draw_painting(image, random);
        break;
    case PosterStyle::Chart:
        draw_chart(image, random);
        break;
    }
    return to_color_image(image);
}

ColorImage draw_label(const Label& label, const Eigen::Vector2d& size, double pixel)
{
    cv::Mat image = canvas(label.upright ? size : Eigen::Vector2d(size.y(), size.x()), pixel);
    image = cv::Scalar(label.paper[0], label.paper[1], label.paper[2]);
    const cv::Scalar ink(label.ink[0], label.ink[1], label.ink[2]);
    cv::rectangle(image, {2, 2, image.cols - 4, image.rows - 4}, ink, 1, cv::LINE_AA);
    fit_text(image, label.text, part(image, 0.08, 0.12, 0.84, 0.76), ink);
    if (!label.upright) cv::rotate(image, image, cv::ROTATE_90_CLOCKWISE);
    return to_color_image(image);
}

} // namespace quoin
