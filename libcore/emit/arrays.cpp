#include "emit/arrays.h"

#include <algorithm>
#include <fmt/format.h>
#include <optional>
#include <set>

namespace quoin {
namespace {

// Which array makes what, by stage and scan.
using Makers = std::vector<std::vector<std::optional<std::size_t>>>;

std::vector<std::size_t> makers_of_inputs(const ArrayStage& stage, std::size_t scan, const Makers& makers)
{
    std::set<std::size_t> arrays;
    for (const std::size_t before : stage.after)
        if (const auto maker = makers[before][scan]) arrays.insert(*maker);
    return {arrays.begin(), arrays.end()};
}

} // namespace

std::vector<JobArray> plan_arrays(const std::vector<ArrayStage>& stages, std::size_t max_array)
{
    std::vector<JobArray> arrays;
    Makers makers;
    for (std::size_t s = 0; s < stages.size(); ++s) {
        makers.emplace_back(stages[s].is_stale.size());
        const std::size_t first = arrays.size(); // of this stage's
        for (std::size_t scan = 0; scan < stages[s].is_stale.size(); ++scan) {
            if (!stages[s].is_stale[scan]) continue;
            const std::size_t offset = scan / max_array * max_array;
            const auto follows = makers_of_inputs(stages[s], scan, makers);
            auto array = std::find_if(arrays.begin() + static_cast<std::ptrdiff_t>(first), arrays.end(),
                                      [&](const JobArray& a) { return a.offset == offset && a.follows == follows; });
            if (array == arrays.end()) {
                const std::string name = fmt::format("{}.{}", stages[s].name, arrays.size() - first + 1);
                array = arrays.insert(array, {name, s, offset, {}, follows});
            }
            array->elements.push_back(scan - offset);
            makers[s][scan] = static_cast<std::size_t>(array - arrays.begin());
        }
    }
    return arrays;
}

std::string elements_text(const std::vector<std::size_t>& elements)
{
    std::string text;
    for (std::size_t i = 0; i < elements.size();) {
        std::size_t last = i;
        while (last + 1 < elements.size() && elements[last + 1] == elements[last] + 1)
            ++last;
        text += fmt::format("{}{}", text.empty() ? "" : ",", elements[i]);
        if (last > i) text += fmt::format("-{}", elements[last]);
        i = last + 1;
    }
    return text;
}

} // namespace quoin
