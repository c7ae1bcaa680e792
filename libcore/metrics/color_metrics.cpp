#include "base/parallel.h"
#include "metrics/image_quality.h"
#include "metrics/surface.h"
#include "metrics/truth_metrics.h"
#include "render/textured.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace quoin {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr std::size_t kColorGrain = 1024;

// Colour of a model's point, 0..255.
using ColorOf = std::function<Vector3f(FaceId, const Vector3d& weights)>;

struct ColoredSurface {
    std::string name; // prefix of its figures
    const TriangleMesh& mesh;
    ColorOf color_of;
};

void add_true_color(MetricList& list, const ColoredSurface& colored, const GroundTruth& truth,
                    const EvaluateParams& params)
{
    const TriangleMesh& mesh = colored.mesh;
    const NearestItem surface(mesh);
    const double least_cosine = std::cos(params.match_angle / kDegrees);
    const int count = static_cast<int>(truth.sample.size());
    ColorImage found(count, 1), real(count, 1);
    Mask mask(count, 1);
    parallel_for(
        truth.sample.size(),
        [&](std::size_t i) {
            const TrueSample& s = truth.sample[i];
            if (!params.observed(s)) return;
            const auto near = surface.find(s.position.cast<double>(), params.match_distance);
            if (!near || face_normal(mesh, near->item).dot(s.normal.cast<double>()) < least_cosine) return;
            const Vector3f color = colored.color_of(near->item, barycentric(mesh, near->item, near->point));
            for (int c = 0; c < 3; ++c)
                found.pixels[i][static_cast<std::size_t>(c)] =
                    static_cast<std::uint8_t>(std::clamp(color[c] + 0.5f, 0.0f, 255.0f));
            real.pixels[i] = s.color;
            mask.pixels[i] = 1;
        },
        kColorGrain);
    const auto seen = std::count_if(truth.sample.begin(), truth.sample.end(),
                                    [&](const TrueSample& s) { return params.observed(s); });
    const auto matched = std::count(mask.pixels.begin(), mask.pixels.end(), 1);
    list.higher(colored.name + ".coverage", "", static_cast<double>(matched) / static_cast<double>(seen));
    list.higher(colored.name + ".psnr", "dB",
                psnr(apply_color(fit_affine_color(found, real, mask), found), real, mask));
}

} // namespace

void add_true_color_metrics(MetricList& list, const TexturedMesh* textured, const TriangleMesh* dense,
                            const GroundTruth& truth, const EvaluateParams& params)
{
    if (textured) {
        const TexturedModel model(*textured);
        const auto color_of = [&](FaceId f, const Vector3d& weights) {
            return model.sample(f, model.texel(f, weights), 1.0);
        };
        add_true_color(list, {"texture.truth", textured->planes.mesh, color_of}, truth, params);
    }
    if (dense && !dense->color.empty()) {
        const auto color_of = [&](FaceId f, const Vector3d& weights) {
            Vector3f sum = Vector3f::Zero();
            for (std::size_t k = 0; k < 3; ++k) {
                const Rgb8& c = dense->color[dense->face[f][k]];
                sum += static_cast<float>(weights[static_cast<int>(k)]) * Vector3f(c[0], c[1], c[2]);
            }
            return sum;
        };
        add_true_color(list, {"dense.truth", *dense, color_of}, truth, params);
    }
}

} // namespace quoin
