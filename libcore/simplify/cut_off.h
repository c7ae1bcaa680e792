#pragma once

#include "mesh/plane_mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace quoin {

// The pieces that a zone has fallen into beside its largest one, each ascending, when it was whole until faces were
// taken out of it. `beside`: its faces on the other side of their edges, in any order. Costs as much as the smaller
// pieces do. opposite: of the half-edges. mark: 0 for every face of the zone, then and now.
std::vector<std::vector<FaceId>> cut_off_pieces(const std::vector<PlaneId>& zone_of,
                                                const std::vector<std::uint32_t>& opposite,
                                                std::span<const FaceId> beside, std::vector<std::uint32_t>& mark);

} // namespace quoin
