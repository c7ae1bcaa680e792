#include "alignment/step.h"

namespace quoin {

AlignmentState moved(const AlignmentState& state, const StepVector& step)
{
    const StepLayout layout{state.camera_from_world.size(), state.plane.size()};
    AlignmentState result = state;
    for (std::size_t k = 0; k < layout.frames; ++k) {
        const Twist twist = step.segment<6>(layout.pose(k));
        if (!twist.isZero(0.0)) result.camera_from_world[k] = moved(state.camera_from_world[k], twist);
    }
    for (std::size_t p = 0; p < layout.planes; ++p) {
        const Vector3 by = step.segment<3>(layout.plane(p));
        if (!by.isZero(0.0)) result.plane[p] = state.plane[p].moved(by);
    }
    const CalibrationStep calibration = step.segment<9>(layout.calibration());
    if (!calibration.isZero(0.0)) result.color = state.color.moved(calibration);
    return result;
}

} // namespace quoin
