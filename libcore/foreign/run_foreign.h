// Runs foreign programs as stages: parameters are checked, results validated, published whole and kept in the store
// under a key that holds the content of the program's files. The program itself only computes.
//
//     run-command USE [--code FILE]... STAGE-OPTIONS        USE: a program, x.yaml, or x.yaml#stage
#pragma once

namespace quoin {

// Returns the stage's exit code.
int run_foreign_stage(int argc, char** argv);

} // namespace quoin
