#include "quoin/emission.h"

#include "pipeline/locate.h"

namespace quoin {

void EmissionOptions::add_to(CLI::App& app)
{
    pipeline.add_to(app);
    pipeline.add_variant_to(app);
    place.add_to(app);
    app.add_option("--from", selection.from, "begin at this stage; results of earlier ones are taken as they are");
    app.add_option("--until", selection.until, "end at this stage");
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
