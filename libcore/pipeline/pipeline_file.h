// Reading pipelines and parameter sets from YAML, and laying parameter sets and command-line settings over a pipeline.
//
//     version: 1
//     extends: indoor.yaml  # optional, or the name of one of Quoin's own: what stands here is laid over it; a null
//                           # removes a stage, wire or parameter
//     scans: [../kitchen, ../office]      # optional: or {kitchen: DIR, ...}, or {glob: "../scans/*"}
//     stages:
//       import: {use: import, in: {folder: $scan}}
//       fuse:   {use: fuse, in: {scan: import.scan}, params: {voxel_size: 0.01}}
//       mine:   {use: ./my-stage, code: [helpers.py], in: {mesh: fuse.mesh}}    # `exec:`: see command_file.h
//     variants: ...  matrix: ...  ablate: ...  report: ...      # see study.h
#pragma once

#include "pipeline/pipeline.h"

#include <filesystem>
#include <string>

namespace quoin {

// What is wrong is added to `problems`; throws UsageError when the file itself cannot be read.
Pipeline read_pipeline(const std::filesystem::path& path, Problems& problems);

// The same from a text; `path` names it in messages and is what relative programs and `extends` refer to.
Pipeline parse_pipeline(const std::filesystem::path& path, const std::string& text, Problems& problems);

// Lays a map {stage: {use: ..., in: ..., params: ...}} over the pipeline; relative programs are in `folder`.
void apply_stages(Pipeline& pipeline, const YamlNode& stages, const std::filesystem::path& folder, Problems& problems);

// Lays a parameter set {stage: {param: value}} over the pipeline.
void apply_config(Pipeline& pipeline, const std::filesystem::path& path, Problems& problems);

// Lays "stage.param=value" (-S) over the pipeline.
void apply_setting(Pipeline& pipeline, const std::string& argument, Problems& problems);

// Lays "stage=PROGRAM" (--use) over the pipeline; a relative path is one against the working directory.
void apply_use(Pipeline& pipeline, const std::string& argument, Problems& problems);

} // namespace quoin
