// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "apps/pictures/still.hpp"
#include "apps/report/report_model.hpp"
#include "apps/report/report_sampler.hpp"
#include "core/text/escape_html.hpp"
#include "graph/events/event_score.hpp"
#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::apps {

/// Bounds on the pictures of a report, in bytes of JPEG and in number. With the data the page stays below
/// kReportBytes for any clip. Chosen so that a report can be sent by mail.
constexpr std::size_t kReportBytes = 8'000'000;
constexpr std::size_t kStillBytes = 1'750'000, kStills = 6;  ///< three layers each
constexpr std::size_t kEventFrameBytes = 1'450'000, kEventFrames = 90;
constexpr std::size_t kMatchBytes = 700'000, kMatches = 6;
constexpr std::size_t kTrajectoryBytes = 130'000;
constexpr std::size_t kClipBytes = 1'000'000;  ///< of video

/// One frame: input, sketch, and reconstruction from the sketch.
struct ReportStill {
  int frame = 0;
  Still input, sketch, reconstruction;
  double psnr = 0;   ///< dB
  double share = 0;  ///< sketchable, 0…1
};
/// A frame in which events happen, or a pair of matched frames.
struct ReportPicture {
  int frame = 0;
  Still still;
};

struct ReportInput {
  std::string clip;          ///< its name, as the user gave it
  std::string command_line;  ///< what was typed
  std::string version;
  const graph::MotionGraph* motion = nullptr;
  std::span<const graph::Event> events;           ///< ordered by frame
  std::vector<ReportStill> stills;                ///< at most kStills
  std::vector<ReportPicture> event_frames;        ///< at most kEventFrames
  std::vector<ReportPicture> matches;             ///< at most kMatches
  std::optional<Still> trajectories;              ///< strokes in space and time (draw_trajectories)
  const mcmc::MotionModel* model = nullptr;       ///< what was learned, where it was
  std::vector<std::complex<double>> eigenvalues;  ///< of the linear dynamic texture, where there is one
  std::optional<ReportClips> clips;               ///< drawn from the models, beside their source
  std::optional<ReportMeasures> measures;         ///< how close these come
  const mcmc::InferResult* sampled = nullptr;     ///< where there was a sampler
  std::span<const graph::Event> all_events;       ///< its events of whatever probability
  std::vector<RateInterval> rates;                ///< and its rates
};

/// Returns the report as one self-contained HTML page. `summary`: the content of summary.json.
std::string make_report(const ReportInput& input, const nlohmann::ordered_json& summary);

/// Replaces each {{name}} by its value in one pass, so that values are never read as a template.
std::string fill_in(std::string_view page,
                    const std::vector<std::pair<std::string_view, std::string_view>>& values);

using core::escape_html;

/// Writes compact JSON that may stand inside a script element; bytes that are no UTF-8 are replaced.
std::string embed_json(const nlohmann::ordered_json& value);

}  // namespace emberfold::apps
