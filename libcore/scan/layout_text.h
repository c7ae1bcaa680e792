// Text files of data sets: numbers, matrices, trajectories and lists with time stamps.
#pragma once

#include "scan/layout.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace quoin {

// Numbers separated by white space or commas. What is no number (nan, -1.#IND, a word) becomes NaN.
std::vector<double> parse_numbers(std::string_view text);

// Lines without '#' comments and empty ones, split at white space or commas.
std::vector<std::vector<std::string>> read_table(const std::filesystem::path& path);

// 16 numbers, row by row; a matrix of NaN when there are fewer.
Eigen::Matrix4d matrix_from(const std::vector<double>& numbers, std::size_t first = 0);
Eigen::Matrix4d read_matrix(const std::filesystem::path& path);

// tx ty tz qx qy qz qw; a matrix of NaN when a number is missing or the quaternion is not of unit length.
Eigen::Matrix4d matrix_from_tum(const std::vector<double>& numbers, std::size_t first);

struct TimedPose {
    double time = 0.0; // [s]
    Eigen::Matrix4d pose;
};

// "time tx ty tz qx qy qz qw" lines, in order of time.
std::vector<TimedPose> read_tum_trajectory(const std::filesystem::path& path);

// The pose at a time: between its two neighbours when both are within `max_gap`, else the nearest within it, else NaN.
Eigen::Matrix4d pose_at(const std::vector<TimedPose>& trajectory, double time, double max_gap);

struct TimedFile {
    double time = 0.0; // [s]
    std::string name;
};

// For each first time the index of its partner among the second times, at most `max_gap` apart: closest pairs first,
// each used once (as the tools of the TUM benchmark do). Both in ascending order.
std::vector<std::optional<std::size_t>> associate(const std::vector<TimedFile>& first,
                                                  const std::vector<TimedFile>& second, double max_gap);

// Does the file exist in the folder? Counts it in `absent` otherwise.
bool is_present(const std::filesystem::path& folder, const std::string& name, AbsentFiles& absent);

// Image files of a subfolder, as "subfolder/name", sorted by the number their name begins with, then by name.
std::vector<std::string> sorted_images(const std::filesystem::path& folder, const std::string& subfolder);

// The number that a file name begins with (0 without one): 12 of "depth/0012_raw.png".
long leading_number(const std::string& name);

// The number of the last run of digits before the first '.' of a name ("frame-000012.color.jpg" is 12), if it has one.
std::optional<long> number_of(const std::string& name);

} // namespace quoin
