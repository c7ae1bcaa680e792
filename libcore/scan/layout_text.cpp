#include "scan/layout_text.h"

#include "base/atomic_file.h"
#include "base/error.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <tuple>

namespace quoin {
namespace fs = std::filesystem;
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::vector<std::string> split(std::string_view line, std::string_view separators)
{
    std::vector<std::string> words;
    for (std::size_t begin = line.find_first_not_of(separators); begin != std::string_view::npos;) {
        const std::size_t end = std::min(line.find_first_of(separators, begin), line.size());
        words.emplace_back(line.substr(begin, end - begin));
        begin = line.find_first_not_of(separators, end);
    }
    return words;
}

double number_from(std::string_view word)
{
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = kNaN;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return error == std::errc() && end == word.data() + word.size() ? value : kNaN;
}

Eigen::Matrix4d no_pose() { return Eigen::Matrix4d::Constant(kNaN); }

Eigen::Matrix4d interpolated(const TimedPose& a, const TimedPose& b, double time)
{
    const double weight = b.time > a.time ? (time - a.time) / (b.time - a.time) : 0.0;
    const Eigen::Quaterniond qa(Eigen::Matrix3d(a.pose.topLeftCorner<3, 3>())),
        qb(Eigen::Matrix3d(b.pose.topLeftCorner<3, 3>()));
    Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
    pose.topLeftCorner<3, 3>() = qa.slerp(weight, qb).toRotationMatrix();
    pose.topRightCorner<3, 1>() =
        (1.0 - weight) * a.pose.topRightCorner<3, 1>() + weight * b.pose.topRightCorner<3, 1>();
    return pose;
}

bool is_image(const fs::path& path)
{
    std::string extension = path.extension().string();
    std::ranges::transform(extension, extension.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    constexpr std::array known{".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".webp"};
    return std::ranges::find(known, extension) != known.end();
}

} // namespace

std::vector<double> parse_numbers(std::string_view text)
{
    std::vector<double> numbers;
    for (const std::string& word : split(text, " \t\r\n,"))
        numbers.push_back(number_from(word));
    return numbers;
}

std::vector<std::vector<std::string>> read_table(const fs::path& path)
{
    std::vector<std::vector<std::string>> rows;
    for (const std::string& line : split(read_text(path), "\r\n")) {
        auto words = split(std::string_view(line).substr(0, line.find('#')), " \t,");
        if (!words.empty()) rows.push_back(std::move(words));
    }
    return rows;
}

Eigen::Matrix4d matrix_from(const std::vector<double>& numbers, std::size_t first)
{
    if (numbers.size() < first + 16) return no_pose();
    return Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data() + first);
}

Eigen::Matrix4d read_matrix(const fs::path& path) { return matrix_from(parse_numbers(read_text(path))); }

Eigen::Matrix4d matrix_from_tum(const std::vector<double>& n, std::size_t first)
{
    constexpr double tolerance = 1e-2; // quaternions are printed with four digits
    if (n.size() < first + 7) return no_pose();
    const Eigen::Quaterniond q(n[first + 6], n[first + 3], n[first + 4], n[first + 5]);
    if (!(std::abs(q.norm() - 1.0) < tolerance)) return no_pose();
    Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
    pose.topLeftCorner<3, 3>() = q.normalized().toRotationMatrix();
    pose.topRightCorner<3, 1>() << n[first], n[first + 1], n[first + 2];
    return pose;
}

std::vector<TimedPose> read_tum_trajectory(const fs::path& path)
{
    std::vector<TimedPose> trajectory;
    for (const auto& row : read_table(path)) {
        std::vector<double> numbers;
        for (const std::string& word : row)
            numbers.push_back(number_from(word));
        if (std::isfinite(numbers[0])) trajectory.push_back({numbers[0], matrix_from_tum(numbers, 1)});
    }
    if (trajectory.empty())
        throw InputError(path.string() + ": no pose in the file; expected lines of 'time tx ty tz qx qy qz qw'");
    std::ranges::stable_sort(trajectory, {}, &TimedPose::time);
    return trajectory;
}

Eigen::Matrix4d pose_at(const std::vector<TimedPose>& trajectory, double time, double max_gap)
{
    const auto after = std::ranges::lower_bound(trajectory, time, {}, &TimedPose::time);
    const bool has_after = after != trajectory.end() && after->time - time <= max_gap;
    const bool has_before = after != trajectory.begin() && time - std::prev(after)->time <= max_gap;
    if (has_before && has_after) return interpolated(*std::prev(after), *after, time);
    if (has_after) return after->pose;
    return has_before ? std::prev(after)->pose : no_pose();
}

std::vector<std::optional<std::size_t>> associate(const std::vector<TimedFile>& first,
                                                  const std::vector<TimedFile>& second, double max_gap)
{
    std::vector<std::tuple<double, std::size_t, std::size_t>> pairs; // gap, first, second
    for (std::size_t i = 0; i < first.size(); ++i) {
        const auto begin = std::ranges::lower_bound(second, first[i].time - max_gap, {}, &TimedFile::time);
        for (auto it = begin; it != second.end() && it->time <= first[i].time + max_gap; ++it)
            pairs.emplace_back(std::abs(it->time - first[i].time), i, static_cast<std::size_t>(it - second.begin()));
    }
    std::ranges::sort(pairs);
    std::vector<std::optional<std::size_t>> partner(first.size());
    std::vector<bool> taken(second.size(), false);
    for (const auto& [gap, i, j] : pairs) {
        if (partner[i] || taken[j]) continue;
        partner[i] = j;
        taken[j] = true;
    }
    return partner;
}

bool is_present(const fs::path& folder, const std::string& name, AbsentFiles& absent)
{
    ++absent.named;
    if (fs::is_regular_file(folder / name)) return true;
    if (absent.count++ == 0) absent.example = name;
    return false;
}

std::vector<std::string> sorted_images(const fs::path& folder, const std::string& subfolder)
{
    std::vector<std::pair<long, std::string>> numbered;
    for (const auto& entry : fs::directory_iterator(folder / subfolder))
        if (entry.is_regular_file() && is_image(entry.path())) {
            const std::string name = subfolder + "/" + entry.path().filename().string();
            numbered.emplace_back(leading_number(name), name);
        }
    std::ranges::sort(numbered);
    std::vector<std::string> names;
    for (auto& [number, name] : numbered)
        names.push_back(std::move(name));
    return names;
}

long leading_number(const std::string& name)
{
    const std::string file = fs::path(name).filename().string();
    long number = 0;
    std::from_chars(file.data(), file.data() + file.size(), number);
    return number;
}

std::optional<long> number_of(const std::string& name)
{
    const std::string stem = name.substr(0, name.find('.'));
    const std::size_t end = stem.find_last_of("0123456789");
    if (end == std::string::npos) return std::nullopt;
    const std::size_t before = stem.find_last_not_of("0123456789", end);
    const std::size_t begin = before == std::string::npos ? 0 : before + 1;
    long number = 0;
    const auto [last, error] = std::from_chars(stem.data() + begin, stem.data() + end + 1, number);
    return error == std::errc() ? std::optional(number) : std::nullopt;
}

} // namespace quoin
