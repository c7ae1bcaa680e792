// One self-contained page that shows a model and everything known about it: no network, no other file.
#pragma once

#include "base/metrics.h"
#include "mesh/line_matches.h"
#include "mesh/textured_mesh.h"
#include "scan/alignment.h"
#include "scan/keyframes.h"
#include "scan/scan.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace quoin {

struct StageFigures {
    std::string name;
    double seconds = 0.0;
    std::uint64_t peak_memory_bytes = 0;
    std::string params_json = "{}";
};

// What there is to show; absent things are null or empty, and the page leaves their part out.
struct ReportParts {
    std::string scan_name, pipeline;
    std::string generator;                      // "Quoin 0.1.0"
    std::string model_file;                     // of the GLB, relative to the page
    std::string digest;                         // of what the page is made from; stands in its head
    Rigid model_from_world = Rigid::Identity(); // +y up
    const TexturedMesh* textured = nullptr;     // the model, or else
    const PlaneMesh* planes = nullptr;          // the model without texture
    const TriangleMesh* dense = nullptr;        // what was there before
    const Scan* scan = nullptr;
    const ScanImages* images = nullptr; // with scan, keyframes and lines: photographs with their lines
    const Keyframes* keyframes = nullptr;
    const Alignment* alignment = nullptr;
    std::optional<HeldOutScores> draft_scores; // of an alignment before that one, from which its poses come
    const LineMatches* lines = nullptr;
    const Metrics* metrics = nullptr;
    std::vector<StageFigures> stages;
    std::vector<std::uint8_t> face_filled; // of the model; 1 = closes a hole

    const PlaneMesh* model() const { return textured ? &textured->planes : planes; }
};

struct ReportLimits {
    std::size_t dense_faces = 400000; // the dense mesh is made coarser down to about this many
    std::size_t photographs = 8;
    int photograph_width = 640; // [px]
    int jpeg_quality = 80;
};

// The page as text. Throws ImpossibleError when there is neither a textured nor a plane mesh with faces, and InputError
// when the parts do not belong together.
std::string make_report(const ReportParts& parts, const ReportLimits& limits = {});

// The digest in the head of a page, or "" when the text is none.
std::string report_digest(const std::string& page);

} // namespace quoin
