#include "schema/matrices.h"

#include <array>
#include <cmath>

namespace quoin {
namespace {

using Matrix = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
using Numbers16 = std::array<double, 16>;
using Numbers8 = std::array<double, 8>;
using Numbers4 = std::array<double, 4>;

Numbers16 numbers_of(const Rigid& transform)
{
    Numbers16 numbers;
    Eigen::Map<Matrix>(numbers.data()) = transform.matrix();
    return numbers;
}

// A pose that is no pose is kept as it is: the scan marks its frame invalid.
Rigid transform_of(const Numbers16& numbers)
{
    Rigid transform;
    transform.matrix() = Eigen::Map<const Matrix>(numbers.data());
    return transform;
}

} // namespace

void add_transforms(Artifact& artifact, const std::string& name, const std::vector<Rigid>& transforms)
{
    std::vector<Numbers16> rows;
    for (const auto& transform : transforms)
        rows.push_back(numbers_of(transform));
    artifact.add<double>(name, {rows.size(), 4, 4}, rows);
}

std::vector<Rigid> read_transforms(const TensorReader& reader, const std::string& name)
{
    std::vector<Rigid> transforms;
    for (const auto& row : reader.array<double, Numbers16>(name, {kAny, 4, 4}))
        transforms.push_back(transform_of(row));
    return transforms;
}

void add_transform(Artifact& artifact, const std::string& name, const Rigid& transform)
{
    artifact.add<double>(name, {4, 4}, std::vector<Numbers16>{numbers_of(transform)});
}

Rigid read_transform(const TensorReader& reader, const std::string& name)
{
    const auto rows = reader.array<double, Numbers4>(name, {4, 4});
    Numbers16 numbers;
    for (std::size_t i = 0; i < 16; ++i)
        numbers[i] = rows[i / 4][i % 4];
    reader.check_finite(name, numbers.data(), 16);
    Rigid transform = transform_of(numbers);
    if (!is_rigid(transform.matrix())) reader.refuse(name, "is not a rigid transform");
    return transform;
}

void add_camera(Artifact& artifact, const std::string& name, const Camera& c)
{
    const std::vector<double> numbers{
        static_cast<double>(c.width), static_cast<double>(c.height), c.fx, c.fy, c.cx, c.cy, c.k1, c.k2};
    artifact.add<double>(name, {8}, numbers);
}

Camera read_camera(const TensorReader& reader, const std::string& name)
{
    const auto n = reader.array<double, double>(name, {8});
    reader.check_finite(name, n.data(), n.size());
    const auto size_ok = [](double v) { return v >= 0 && v < 1e6 && v == std::floor(v); };
    if (!size_ok(n[0]) || !size_ok(n[1])) reader.refuse(name, "has no valid image size");
    return {static_cast<int>(n[0]), static_cast<int>(n[1]), n[2], n[3], n[4], n[5], n[6], n[7]};
}

void add_planes(Artifact& artifact, const std::string& name, const std::vector<Plane>& planes)
{
    std::vector<Numbers4> rows;
    for (const auto& p : planes)
        rows.push_back({p.normal.x(), p.normal.y(), p.normal.z(), p.offset});
    artifact.add<double>(name, {rows.size(), 4}, rows);
}

std::vector<Plane> read_planes(const TensorReader& reader, const std::string& name)
{
    std::vector<Plane> planes;
    for (const auto& row : reader.array<double, Numbers4>(name, {kAny, 4})) {
        reader.check_finite(name, row.data(), row.size());
        planes.push_back({{row[0], row[1], row[2]}, row[3]});
        if (std::abs(planes.back().normal.norm() - 1.0) > 1e-6)
            reader.refuse(name, "holds a normal that is not of unit length");
    }
    return planes;
}

} // namespace quoin
