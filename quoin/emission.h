// The options of verbs that write a run down for another program instead of carrying it out.
#pragma once

#include "emit/rules.h"
#include "quoin/options.h"

namespace quoin {

struct EmissionOptions {
    PipelineOptions pipeline;
    PlaceOptions place;
    Selection selection;

    void add_to(OptionParser& parser);

    // The checked run. Throws UsageError or InputError with everything that is wrong.
    Emission load() const;
};

} // namespace quoin
