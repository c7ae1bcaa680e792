#include "scan/keyframes.h"

#include "schema/schema.h"
#include "schema/tensor_io.h"

namespace quoin {

Artifact to_artifact(const Keyframes& keyframes)
{
    Artifact artifact{"keyframes", 1, {}, {}};
    artifact.add<std::uint32_t>("frame", {keyframes.frame.size()}, keyframes.frame);
    artifact.add<float>("blur", {keyframes.blur.size()}, keyframes.blur);
    artifact.add<std::uint8_t>("reason", {keyframes.reason.size()}, keyframes.reason);
    return artifact;
}

Keyframes read_keyframes(const std::filesystem::path& path)
{
    const Artifact artifact = read_artifact(path, "keyframes", 1);
    const TensorReader reader(artifact, path);
    Keyframes keyframes;
    keyframes.blur = reader.array<float, float>("blur", {kAny});
    keyframes.reason = reader.array<std::uint8_t, Dropped>("reason", {keyframes.blur.size()});
    keyframes.frame = reader.array<std::uint32_t, FrameId>("frame", {kAny});
    reader.check_indices("frame", keyframes.frame.data(), keyframes.frame.size(), keyframes.blur.size());
    for (std::size_t i = 1; i < keyframes.frame.size(); ++i)
        if (keyframes.frame[i] <= keyframes.frame[i - 1]) reader.refuse("frame", "is not ascending");
    return keyframes;
}

} // namespace quoin
