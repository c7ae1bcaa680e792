#include "pipeline/pipeline.h"

#include <algorithm>

namespace quoin {

PipelineStage* Pipeline::find(const std::string& stage)
{
    const auto it = std::ranges::find(stages, stage, &PipelineStage::name);
    return it == stages.end() ? nullptr : &*it;
}

std::vector<std::string> Pipeline::stage_names() const
{
    std::vector<std::string> names;
    for (const auto& stage : stages)
        names.push_back(stage.name);
    return names;
}

void Pipeline::remove(const std::string& stage_name)
{
    const PipelineStage* found = find(stage_name);
    if (!found) return;
    const PipelineStage removed = *found;
    std::erase_if(stages, [&](const PipelineStage& stage) { return stage.name == removed.name; });
    for (auto& stage : stages)
        for (auto wire = stage.inputs.begin(); wire != stage.inputs.end();) {
            const auto behind = removed.inputs.find(wire->second.port);
            if (wire->second.stage != removed.name)
                ++wire;
            else if (behind == removed.inputs.end())
                wire = stage.inputs.erase(wire);
            else
                (wire++)->second = behind->second;
        }
}

} // namespace quoin
