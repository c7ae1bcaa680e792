#include "foreign/run_foreign.h"

int main(int argc, char** argv) { return quoin::run_foreign_stage(argc, argv); }
