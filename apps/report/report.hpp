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

/// Limits of a report's pictures, in bytes of JPEG and in number, so that it can be sent by mail. With the
/// data the page stays below kReportBytes for any clip.
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
/// A frame with events, or a pair of matched frames.
struct ReportPicture {
  int frame = 0;
  Still still;
};

struct ReportInput {
  std::string clip;          ///< its name, as given by the user
  std::string command_line;  ///< as typed
  std::string version;
  const graph::MotionGraph* motion = nullptr;
  std::span<const graph::Event> events;           ///< ordered by frame
  std::vector<ReportStill> stills;                ///< at most kStills
  std::vector<ReportPicture> event_frames;        ///< at most kEventFrames
  std::vector<ReportPicture> matches;             ///< at most kMatches
  std::optional<Still> trajectories;              ///< strokes in space and time (draw_trajectories)
  const mcmc::MotionModel* model = nullptr;       ///< the learned model, if any
  std::vector<std::complex<double>> eigenvalues;  ///< of the linear dynamic texture, if any
  std::optional<ReportClips> clips;               ///< drawn from the models, next to their source
  std::optional<ReportMeasures> measures;         ///< distances of the drawn clips
  const mcmc::SamplerRun* sampled = nullptr;      ///< if a sampler was used
  std::span<const graph::Event> all_events;       ///< its events of any probability
  std::vector<RateInterval> rates;                ///< its rates
};

/// Returns the report as one self-contained HTML page. `summary`: the content of summary.json.
std::string make_report(const ReportInput& input, const nlohmann::ordered_json& summary);

/// Replaces each {{name}} by its value in one pass, so that values are never interpreted as a template.
std::string fill_in(std::string_view page,
                    const std::vector<std::pair<std::string_view, std::string_view>>& values);

using core::escape_html;

/// Writes compact JSON that may stand inside a script element; bytes that are not UTF-8 are replaced.
std::string embed_json(const nlohmann::ordered_json& value);

}  // namespace emberfold::apps
