// The verbs of the driver; each has a file of its own.
#pragma once

#include <string>
#include <vector>

namespace quoin {

using Arguments = std::vector<std::string>; // what follows the verb

int run_verb(const Arguments& arguments);
int plan_verb(const Arguments& arguments);
int why_verb(const Arguments& arguments);
int status_verb(const Arguments& arguments);
int ablate_verb(const Arguments& arguments);
int graph_verb(const Arguments& arguments);
int stages_verb(const Arguments& arguments);
int describe_verb(const Arguments& arguments);
int emit_verb(const Arguments& arguments);
int submit_verb(const Arguments& arguments);
int stage_check_verb(const Arguments& arguments);
int inspect_verb(const Arguments& arguments);
int report_verb(const Arguments& arguments);
int diff_verb(const Arguments& arguments);
int log_verb(const Arguments& arguments);
int verify_verb(const Arguments& arguments);
int gc_verb(const Arguments& arguments);
int pin_verb(const Arguments& arguments);
int du_verb(const Arguments& arguments);

} // namespace quoin
