// Notation of the paper: F the image, B the box-filtered image, D_F and D_B their absolute differences of neighbours,
// V = max(0, D_F - D_B), s_F and s_V the sums of D_F and V, b = (s_F - s_V) / s_F along each direction.
#include "keyframes/blur.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace quoin {
namespace {

constexpr int kReach = 4; // of the box on either side of its pixel
constexpr float kTaps = 2 * kReach + 1;

// Sums of one direction, a slot per column: additions of a row do not depend on each other, so they run in parallel
// lanes.
struct Sums {
    std::vector<float> difference; // D_F
    std::vector<float> lost;       // V

    explicit Sums(int width) : difference(static_cast<std::size_t>(width), 0.0f), lost(difference) {}

    // Neighbouring boxes share all but two pixels, so B(p) - B(p-1) = (F(entering) - F(leaving)) / taps: nothing is
    // filtered.
    void add_row(const float* F, const float* previous, const float* entering, const float* leaving)
    {
        for (std::size_t x = 1; x < difference.size(); ++x) {
            const float D_F = std::abs(F[x] - previous[x]);
            const float D_B = std::abs(entering[x] - leaving[x]) * (1.0f / kTaps);
            difference[x] += D_F;
            lost[x] += std::max(0.0f, D_F - D_B);
        }
    }

    bool has_differences() const
    {
        return std::ranges::any_of(difference, [](float sum) { return sum > 0.0f; });
    }

    // 0 without any difference: the direction says nothing.
    double blur() const
    {
        const double s_F = std::accumulate(difference.begin(), difference.end(), 0.0);
        const double s_V = std::accumulate(lost.begin(), lost.end(), 0.0);
        return s_F > 0.0 ? (s_F - s_V) / s_F : 0.0;
    }
};

// A row with its ends repeated, so that every box finds its pixels.
void pad(const float* row, int width, std::vector<float>& padded)
{
    std::fill_n(padded.begin(), kReach + 1, row[0]);
    std::copy_n(row, width, padded.begin() + kReach + 1);
    std::fill_n(padded.begin() + kReach + 1 + width, kReach, row[width - 1]);
}

} // namespace

double blur_of(const GrayImage& gray)
{
    if (gray.empty()) return 1.0;
    Sums along_x(gray.width), along_y(gray.width);
    std::vector<float> padded(static_cast<std::size_t>(gray.width + 2 * kReach + 1));
    for (int y = 1; y < gray.height; ++y) {
        pad(gray.row(y), gray.width, padded);
        const float* F = padded.data() + kReach + 1;
        along_x.add_row(F, F - 1, F + kReach, F - kReach - 1);
        along_y.add_row(gray.row(y), gray.row(y - 1), gray.row(std::min(y + kReach, gray.height - 1)),
                        gray.row(std::max(y - kReach - 1, 0)));
    }
    const bool is_constant = !along_x.has_differences() && !along_y.has_differences();
    return is_constant ? 1.0 : std::max(along_x.blur(), along_y.blur());
}

} // namespace quoin
