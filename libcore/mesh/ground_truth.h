// What is really there: the truth of an invented scan, against which `evaluate` measures.
#pragma once

#include "geometry/plane.h"
#include "geometry/rigid.h"
#include "mesh/triangle_mesh.h"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace quoin {

struct TruePlane {
    std::string name;  // of the object it belongs to
    Plane plane;       // normal towards the free side
    double area = 0.0; // [m^2]
};

// A visible straight edge between two planes, or the part of it that the scan saw or did not see.
struct TrueCrease {
    std::array<Eigen::Vector3d, 2> ends; // world [m]
    std::array<PlaneId, 2> planes{};     // the smaller id first
    double angle = 0.0;                  // between the normals [rad]
    bool concave = false;                // as where a wall meets the floor
    bool observed = false;               // did some frame see both sides here?
};

// What a frame's camera did to the true colours of 0..255, in every channel: gain * true + bias.
struct TrueExposure {
    Eigen::Vector3d gain = Eigen::Vector3d::Ones();
    Eigen::Vector3d bias = Eigen::Vector3d::Zero();
};

struct TrueSample {                   // a random point of the surface
    Eigen::Vector3f position, normal; // world [m]
    Rgb8 color{};
    PlaneId plane = kNoPlane; // kNoPlane on a curved surface
    std::uint32_t views = 0;  // frames whose depth camera saw it
};

struct GroundTruth {
    TriangleMesh mesh;               // exact, with true colours
    std::vector<PlaneId> face_plane; // F, kNoPlane on curved surfaces; empty after reading
    std::vector<TruePlane> plane;
    std::vector<TrueCrease> crease;
    std::vector<double> time;             // N [s]
    std::vector<Rigid> world_from_camera; // N, true poses of the depth camera
    std::vector<TrueExposure> exposure;   // N
    std::vector<TrueSample> sample;
};

// The folder holds mesh.ply, planes.json, creases.json, trajectory.txt (TUM order), exposures.txt (gain and bias of r g
// b, a frame a line) and samples.ply. Reading throws InputError naming file and place when one is missing or malformed.
void write_ground_truth(const std::filesystem::path& folder, const GroundTruth& truth);
GroundTruth read_ground_truth(const std::filesystem::path& folder);
// That of a scan folder; nullopt when it has no ground_truth/.
std::optional<GroundTruth> find_ground_truth(const std::filesystem::path& scan_folder);

} // namespace quoin
