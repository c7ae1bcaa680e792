#include "quoin/emission.h"

#include "pipeline/locate.h"
#include "quoin/option_parser.h"

namespace quoin {

void EmissionOptions::add_to(OptionParser& parser)
{
    pipeline.add_to(parser);
    pipeline.add_variant_to(parser);
    place.add_to(parser);
    parser.option("--from", selection.from, "begin at this stage; results of earlier ones are taken as they are");
    parser.option("--until", selection.until, "end at this stage");
}

Emission EmissionOptions::load() const
{
    Emission emission;
    emission.graph = pipeline.load();
    emission.scans = place.named_scans(emission.graph);
    emission.layout = place.layout();
    emission.tasks = plan_tasks(emission.graph, emission.scans, emission.layout, selection);
    emission.bin = stage_folder();
    return emission;
}

} // namespace quoin
