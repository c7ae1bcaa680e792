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

} // namespace quoin
