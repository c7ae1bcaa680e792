// Vertices onto planes and creases: E_g + lambda_l E_l + lambda_r E_r (Wang & Guo 2019, section 3.5), solved as one
// sparse symmetric system that the three coordinates share.
#pragma once

#include "base/param.h"
#include "mesh/plane_mesh.h"

#include <array>

namespace quoin {

enum class LinearSolver { Cholesky, Pcg };
constexpr auto choice_names(LinearSolver) { return std::array{"cholesky", "pcg"}; }

// Laplacian: |L X|^2 over all neighbours, the paper's, which shrinks and rounds. Displacement: |L (X - X0)|^2 over
// neighbours of one class: of inner vertices all, of border vertices those along the border, of corners none.
enum class Regularizer { Laplacian, Displacement };
constexpr auto choice_names(Regularizer) { return std::array{"laplacian", "displacement"}; }

struct OptimizeGeometryParams {
    LinearSolver solver = LinearSolver::Cholesky;
    Regularizer regularizer = Regularizer::Displacement;
    double lambda_l = 10.0;
    double lambda_r = 0.01;
    int iterations = 5;
    double texel_density = 90000.0;
    double min_face_area = 1e-5;
    double crease_angle = 20.0;
    double max_move = 0.05;
    double max_plane_rms = 0.02;
    double max_deviation = 60.0;
    double solver_tolerance = 1e-10;

    static constexpr auto list()
    {
        using P = OptimizeGeometryParams;
        return std::tuple{
            Param{"solver", &P::solver, "", "sparse Cholesky factorisation, or conjugate gradients; the same result"},
            Param{"regularizer", &P::regularizer, "",
                  "what stays smooth: positions over all neighbours (the paper), or displacements inside a class"},
            Param{"lambda_l", &P::lambda_l, "", "weight of creases and corners, in units of a vertex's own data weight",
                  0.0, 1e6},
            Param{"lambda_r", &P::lambda_r, "",
                  "weight of the regulariser, in units of the mean data weight of a vertex", 0.0, 1e6},
            Param{"iterations", &P::iterations, "", "solves, each from the vertices of the last; 1 is the paper's", 1.0,
                  100.0},
            Param{"texel_density", &P::texel_density, "1/m^2", "texels that pull at a face, by area", 1.0, 1e9},
            Param{"min_face_area", &P::min_face_area, "m^2", "smaller faces pull as much as one of this area", 1e-12,
                  1.0},
            Param{"crease_angle", &P::crease_angle, "deg", "planes at less than this angle form no crease", 0.1, 90.0},
            Param{"max_move", &P::max_move, "m", "farthest that a vertex moves", 0.0, 1.0},
            Param{"max_plane_rms", &P::max_plane_rms, "m",
                  "RMS distance of the dense cluster to its plane above which the plane pulls less, by the square",
                  1e-6, 10.0},
            Param{"max_deviation", &P::max_deviation, "deg",
                  "angle between a face and its plane beyond which the plane does not pull at it, and that no motion "
                  "may exceed",
                  1.0, 90.0},
            Param{"solver_tolerance", &P::solver_tolerance, "", "pcg: relative residual to stop at", 1e-15, 1e-2},
        };
    }
};

// Moves the vertices of `mesh` onto `planes`, which become its planes: one for each, in the same order, e.g. those of
// an Alignment. Connectivity and moments stay; normals that point away from the faces they had are turned over. No
// vertex moves by more than max_move, and no face folds onto a neighbour or shrinks to a line that was not so before.
// No face looks away from its plane: those that would go over to a plane beside them, within max_plane_rms, or to new
// ones behind all others. Faces pull by area, so planes that explain their cluster badly keep its shape. Throws
// InputError if the number of planes differs or one is not finite.
PlaneMesh optimize_geometry(const PlaneMesh& mesh, const std::vector<Plane>& planes,
                            const OptimizeGeometryParams& params);

// E_g of a face in closed form: with `texels` points x = b_1 v_1 + b_2 v_2 + b_3 v_3 spread evenly over the face and
// targets q(x) affine in x, the sum of |q(x) - x|^2 is  sum_jk M_jk (q_j - v_j).(q_k - v_k)  with M = texels / 12 (I +
// 1 1^T).
Eigen::Matrix3d face_mass(double texels);

} // namespace quoin
