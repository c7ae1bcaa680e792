// Sums over the observations of a frame on a plane, in the terms of its flow.
#pragma once

#include "base/lanes.h"

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <utility>

namespace quoin {

// Notation: g = (g_x, g_y) the derivative of a grey by the place (x, y), r = (x, y, 1), and h = (g_x, g_y, g_z) with
// g_z = -(g_x x + g_y y): the third row of a flow F moves a point away, and its picture towards the centre. The
// derivative along F is <h r^T, F>. Its nine terms sum to zero along the diagonal, so that F(2, 2) can be taken off it,
// and eight are left.
inline constexpr int kFlow = 8;
using FlowVector = Eigen::Matrix<double, kFlow, 1>;

inline FlowVector flow_vector(const Eigen::Matrix3d& F)
{
    FlowVector f;
    f << F(0, 0) - F(2, 2), F(0, 1), F(0, 2), F(1, 0), F(1, 1) - F(2, 2), F(1, 2), F(2, 0), F(2, 1);
    return f;
}
inline Eigen::Matrix3d flow_matrix(const FlowVector& s)
{
    Eigen::Matrix3d S;
    S << s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7], -(s[0] + s[4]);
    return S;
}

// The eight terms of h r^T.
using FlowTerms = std::array<Floats, kFlow>;
inline FlowTerms flow_terms(const Floats& by_x, const Floats& by_y, const Floats& x, const Floats& y)
{
    const Floats xx = by_x * x, yy = by_y * y, z = -(xx + yy);
    return {xx, by_x * y, by_x, by_y * x, yy, by_y, z * x, z * y};
}

struct FlowSums {
    Eigen::Matrix<double, kFlow, kFlow> second = Eigen::Matrix<double, kFlow, kFlow>::Zero(); // weight f f^T
    FlowVector first = FlowVector::Zero();                                                    // value f
};

// Terms, weights and values of observations that are yet to be summed: in lanes first, few enough that single precision
// does, then in double precision.
class FlowTile {
public:
    bool is_full() const { return count_ == kTile; }
    void add(const FlowTerms& terms, const Floats& weight, const Floats& value)
    {
        for (std::size_t i = 0; i < kFlow; ++i)
            term_[i][count_] = terms[i];
        weight_[count_] = weight;
        value_[count_++] = value;
    }
    // Moves all to the sums.
    void flush(FlowSums& sums)
    {
        add_rows(sums, std::make_index_sequence<kFlow>());
        count_ = 0;
    }

private:
    static constexpr std::size_t kTile = 32; // lanes of eight

    template <std::size_t... kRow>
    void add_rows(FlowSums& sums, std::index_sequence<kRow...>) const
    {
        (add_row<kRow>(sums), ...);
    }
    // All sums of a row stay in registers.
    template <std::size_t kRow>
    void add_row(FlowSums& sums) const
    {
        std::array<Floats, kFlow - kRow> products{};
        Floats first{};
        for (std::size_t k = 0; k < count_; ++k) {
            const Floats weighted = weight_[k] * term_[kRow][k];
            for (std::size_t j = kRow; j < kFlow; ++j)
                products[j - kRow] += weighted * term_[j][k];
            first += value_[k] * term_[kRow][k];
        }
        constexpr auto kAt = static_cast<Eigen::Index>(kRow);
        for (Eigen::Index j = kAt; j < kFlow; ++j)
            sums.second(j, kAt) += sum(products[static_cast<std::size_t>(j - kAt)]);
        sums.first[kAt] += sum(first);
    }

    std::array<std::array<Floats, kTile>, kFlow> term_;
    std::array<Floats, kTile> weight_, value_;
    std::size_t count_ = 0;
};

} // namespace quoin
