#include "alignment/gauge.h"

#include <gmock/gmock.h>

namespace quoin {
namespace {

// A square of 2 m about `center`, seen along `normal`, with 1 mm of noise.
PlaneScatter square(const Vector3& center, const Vector3& normal)
{
    const TangentBasis axes = centered({normal, -normal.dot(center)}, center).tangents();
    return {center, 1000.0 * (axes * axes.transpose() / 3.0 + 1e-6 * normal * normal.transpose()), 1000.0};
}

const std::vector<Vector3> kNormals{Vector3::UnitX(), Vector3::UnitY(), Vector3::UnitZ(),
                                    Vector3(1, 1, 0).normalized()};

std::vector<PlaneScatter> room()
{
    std::vector<PlaneScatter> scatter;
    for (const Vector3& normal : kNormals)
        scatter.push_back(square(Vector3(1, 2, 3) + 2.0 * normal, normal));
    return scatter;
}

// Planes and a camera that fit room() after `motion`.
AlignmentState moved_room(const Rigid& motion)
{
    AlignmentState state;
    const auto scatter = room();
    for (std::size_t i = 0; i < scatter.size(); ++i) {
        const Vector3 normal = motion.linear() * kNormals[i];
        state.plane.push_back(centered({normal, -normal.dot(motion * scatter[i].center)}, scatter[i].center));
    }
    state.camera_from_world = {exp_twist(twist({0.1, 0.2, 0.3}, {1, 2, 3})) * motion.inverse()};
    state.exposure.resize(1);
    return state;
}

TEST(Gauge, BringsARigidlyMovedSolutionBack)
{
    const AlignmentState state =
        returned_to_mesh(moved_room(exp_twist(twist({0.02, -0.01, 0.03}, {0.03, 0.02, -0.05}))), room());
    const AlignmentState expected = moved_room(Rigid::Identity());
    for (std::size_t i = 0; i < kNormals.size(); ++i) {
        EXPECT_NEAR((state.plane[i].normal - kNormals[i]).norm(), 0.0, 1e-7);
        EXPECT_NEAR(state.plane[i].signed_distance(room()[i].center), 0.0, 1e-7);
    }
    EXPECT_NEAR((state.camera_from_world[0].matrix() - expected.camera_from_world[0].matrix()).norm(), 0.0, 1e-6);
}

TEST(Gauge, KeepsWhatTheCameraSeesOfThePlanes)
{
    AlignmentState state = moved_room(exp_twist(twist({0.02, 0, 0.01}, {0.05, 0, 0})));
    state.plane[0].offset += 0.02; // one plane disagrees with the mesh
    const auto seen = [](const AlignmentState& s, std::size_t i) {
        const Vector3 normal = s.camera_from_world[0].linear() * s.plane[i].normal;
        const Vector3 point = s.camera_from_world[0] * s.plane[i].project(s.plane[i].center);
        return Eigen::Vector4d(normal.x(), normal.y(), normal.z(), -normal.dot(point));
    };
    const AlignmentState returned = returned_to_mesh(state, room());
    for (std::size_t i = 0; i < kNormals.size(); ++i)
        EXPECT_NEAR((seen(returned, i) - seen(state, i)).norm(), 0.0, 1e-9);
}

TEST(Gauge, LeavesASolutionWithoutPlanesAlone)
{
    AlignmentState state;
    state.camera_from_world = {exp_twist(twist({0.1, 0, 0}, {1, 0, 0}))};
    EXPECT_TRUE(returned_to_mesh(state, {}).camera_from_world[0].isApprox(state.camera_from_world[0], 1e-12));
}

TEST(Gauge, ParallelPlanesDoNotSendItSliding)
{
    std::vector<PlaneScatter> scatter{square({0, 0, 0}, Vector3::UnitZ()), square({0, 0, 1}, Vector3::UnitZ())};
    AlignmentState state;
    for (const double z : {0.01, 1.01})
        state.plane.push_back(centered({Vector3::UnitZ(), -z}, {0, 0, z - 0.01}));
    const AlignmentState returned = returned_to_mesh(state, scatter);
    EXPECT_NEAR(returned.plane[0].offset, 0.0, 1e-6);
    EXPECT_NEAR(returned.plane[1].offset, 0.0, 1e-6);
}

} // namespace
} // namespace quoin
