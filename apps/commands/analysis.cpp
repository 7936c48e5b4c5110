// SPDX-License-Identifier: Apache-2.0
#include "apps/commands/analysis.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <set>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "apps/builtin/open_clip.hpp"
#include "apps/cli/summary.hpp"
#include "apps/pictures/pictures.hpp"
#include "apps/pictures/png.hpp"
#include "apps/pictures/rate_map.hpp"
#include "apps/pictures/still.hpp"
#include "apps/pictures/trajectory_picture.hpp"
#include "apps/report/report_model.hpp"
#include "apps/report/report_network.hpp"
#include "apps/report/report_sampler.hpp"
#include "apps/review/review_page.hpp"
#include "apps/review/review_summary.hpp"
#include "apps/runs/run_estimate.hpp"
#include "apps/units/event_units.hpp"
#include "core/freed_memory.hpp"
#include "core/io/mapped_memory.hpp"
#include "core/io/model_folder.hpp"
#include "graph/events/event_score.hpp"
#include "graph/io/contact_tables.hpp"
#include "graph/io/curve_tables.hpp"
#include "graph/io/motion_io.hpp"
#include "graph/io/network_table.hpp"
#include "graph/network/tip_growth.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

void write_data(io::OutputFolder& output, const pipeline::Analysis& found,
                std::span<const graph::TopologyChange> changes, bool jsonl, const graph::Units& units) {
  const auto& motion = found.motion;
  const auto& events = found.events;
  if (jsonl) {
    output.write("sketch.jsonl", [&](std::ostream& out) { graph::write_sketch(out, found.sketched.sketch); });
    output.write("motion.jsonl", [&](std::ostream& out) { graph::write_motion(out, motion); });
  }
  write_events(output, found, units);
  output.write("trajectories.csv", [&](std::ostream& out) { graph::write_trajectories(out, motion, units); });
  output.write("strokes.csv", [&](std::ostream& out) { graph::write_strokes(out, motion, units); });
  output.write("named_events.csv",
               [&](std::ostream& out) { graph::write_named_events(out, events, found.contacts, units); });
  output.write("contacts.csv",
               [&](std::ostream& out) { graph::write_contacts(out, graph::curve_contacts(motion), units); });
  output.write("network.csv", [&](std::ostream& out) { graph::write_network(out, motion, units); });
  output.write("topology.csv", [&](std::ostream& out) { graph::write_topology(out, changes, units); });
  output.write("tips.csv",
               [&](std::ostream& out) { graph::write_tips(out, graph::tip_motions(motion), units); });
  output.write("curves.csv", [&](std::ostream& out) { graph::write_curves(out, motion, units); });
  output.write("joints.csv", [&](std::ostream& out) { graph::write_joints(out, found.joints, units); });
}

Json per_frame_json(const graph::MotionGraph& motion, const std::vector<graph::Event>& events) {
  Json patches = Json::array(), strokes = Json::array();
  std::vector<std::size_t> count(motion.sketch.frames.size());
  for (const auto& graph : motion.sketch.frames) {
    patches.push_back(graph.size());
    strokes.push_back(graph::components(graph).count);
  }
  for (const auto& event : events) ++count.at(static_cast<std::size_t>(event.frame));
  return {{"patches", patches}, {"strokes", strokes}, {"events", count}};
}

/// Returns the mean gain of the patches of the reconstructed frames; null without patches.
Json gain_json(const pipeline::GainTotals& gains) {
  if (gains.patches == 0) return nullptr;
  const auto patches = static_cast<double>(gains.patches);
  return {{"mean", std::round(gains.nats / patches * 100) / 100},
          {"positive_share", std::round(static_cast<double>(gains.positive) / patches * 10000) / 10000},
          {"patches", gains.patches}};
}

Json sketch_json(const Json& per_frame, const Pictures& pictures) {
  const auto mean = [](const Json& list) {
    double total = 0;
    for (const auto& value : list) total += value.get<double>();
    return std::round(total / std::max<double>(1, double(list.size())) * 100) / 100;
  };
  std::size_t patches = 0;
  for (const auto& value : per_frame["patches"]) patches += value.get<std::size_t>();
  const Json share = spread_json(pictures.share);
  return {{"patches", patches},
          {"patches_per_frame", mean(per_frame["patches"])},
          {"strokes_per_frame", mean(per_frame["strokes"])},
          {"sketchable_share", share.is_null() ? Json(0) : share["mean"]},
          {"psnr", spread_json(pictures.psnr)},
          {"coding_gain", gain_json(pictures.gains)}};
}

Json motion_json(const graph::MotionGraph& motion) {
  std::set<std::uint32_t> strokes, curves;
  std::size_t links = 0;
  for (const auto& graph : motion.sketch.frames)
    for (const auto& vertex : graph.vertices())
      strokes.insert(vertex.subgraph.value), curves.insert(vertex.curve.value);
  for (const auto& gap : motion.links) links += gap.size();
  return {{"strokes", strokes.size()},
          {"curves", curves.size()},
          {"links", links},
          {"trajectories", graph::trajectories(motion).size()}};
}

/// Returns the expected number of true events, by class, and its SD, assuming independence.
Json expected_json(const std::vector<graph::Event>& all) {
  const auto rounded = [](double v) { return std::round(10 * v) / 10; };
  Json classes = Json::object();
  double total = 0, variance = 0, likeliest = 0;
  for (const auto type : graph::all_event_types()) {
    double sum = 0;
    for (const graph::Event& e : all)
      if (e.type == type) sum += e.probability;
    classes[std::string(graph::name(type))] = rounded(sum);
    total += sum;
  }
  for (const graph::Event& e : all) {
    variance += e.probability * (1 - e.probability);
    likeliest = std::max(likeliest, e.probability);
  }
  return {{"of", all.size()},
          {"total", rounded(total)},
          {"sd", rounded(std::sqrt(variance))},
          {"likeliest", std::round(100 * likeliest) / 100},
          {"classes", classes}};
}

/// Counts the sure, likely and doubtful events among `all` candidates.
Json certainty_json(const std::vector<graph::Event>& all) {
  constexpr double kSure = 0.9, kLikely = 0.5, kDoubtful = 0.05;
  const auto count = [&](double from, double to) {
    return std::ranges::count_if(
        all, [&](const graph::Event& e) { return e.probability >= from && e.probability < to; });
  };
  return {{"sure", count(kSure, 2)},
          {"likely", count(kLikely, kSure)},
          {"doubtful", count(kDoubtful, kLikely)},
          {"expected", expected_json(all)}};
}

Json events_json(const std::vector<graph::Event>& events, std::size_t frames) {
  Json classes = Json::object();
  for (const auto type : graph::all_event_types())
    classes[std::string(graph::name(type))] = std::ranges::count(events, type, &graph::Event::type);
  const double per_frame = double(events.size()) / double(std::max<std::size_t>(1, frames - 1));
  return {{"total", events.size()}, {"per_frame", std::round(per_frame * 1000) / 1000}, {"classes", classes}};
}

Json files_json(const AnalyzeOptions& options, bool keeps) {
  Json files = {
      {"events.json", "the events of strokes"},
      {"events.csv", "the same as a table"},
      {"events_all.json", "those less probable too"},
      {"trajectories.csv", "every patch through time"},
      {"model/", "what was learned: 'emberfold synth' draws new clips from it"},
      {"strokes.csv", "every stroke through time"},
      {"curves.csv", "every curve through time: its name stays where it touches and crosses others"},
      {"joints.csv", "where one curve goes on, or two touch"},
      {"named_events.csv", "whether tips or sides met and parted at the events"},
      {"contacts.csv", "which curves touch and cross, and how long"},
      {"topology.csv", "each change of topology and what it adds to tips, branches, components and loops"},
      {"tips.csv", "when each tip grows, retracts and pauses, and how fast"},
      {"review.html", "asks whether doubtful events happened; 'analyze --review' takes the answers"},
      {"network.csv", "length, tips, junctions, loops and meshes of each frame"},
      {"lives.csv", "how long each stroke lives, grows and moves"},
      {"birth_map.png", "where strokes are born"},
      {"death_map.png", "where they die"},
      {"trajectories.png", "strokes in space and time, with their events"},
      {"overlay.mp4", "the clip with its graph and events"},
      {"matches/", "neighbouring frames, matched"},
      {"summary.json", "all figures"}};
  if (keeps) files["stages/"] = "what each step made: the same command goes on from there";
  if (options.jsonl) {
    files["motion.jsonl"] = "graphs and their links, a line a frame";
    files["sketch.jsonl"] = "the sketch of every frame, before strokes are followed";
  }
  if (options.reconstruction) files["reconstruction.avi"] = "the clip drawn from its sketch";
  return files;
}

std::vector<RateInterval> rates_a_frame(const pipeline::Analysis& found) {
  std::vector<RateInterval> rates;
  for (const auto type : graph::all_event_types()) {
    const auto& rate = found.rates[static_cast<std::size_t>(type)];
    rates.push_back({std::string(graph::name(type)), rate.mean, rate.low, rate.high, "a frame"});
  }
  return rates;
}

Json analysis_json(const pipeline::Analysis& found, const AnalyzeOptions& options, const Pictures& pictures,
                   Json begun) {
  Json& summary = begun;
  const auto& motion = found.motion;
  summary["options"] = {
      {"reading", reading_json(options.read)}, {"sketch", options_json(options.sketch)},
      {"match", options_json(options.match)},  {"bottom_up", options.bottom_up},
      {"curve_events", options.curve_events},  {"least_probability", options.least_probability}};
  Json per_frame = per_frame_json(motion, found.events);
  summary["sketch"] = sketch_json(per_frame, pictures);
  summary["motion"] = motion_json(motion);
  summary["events"] = events_json(found.events, motion.sketch.frames.size());
  if (!options.bottom_up) summary["events"].update(certainty_json(found.all_events));
  summary["events"]["cuts"] = found.cuts;
  summary["model"] = motion_model_figures(found.model.motion);
  const auto& sharpening = found.model.sharpening;
  summary["model"]["blur_share"] = std::round(sharpening.blur_share * 1000) / 1000;
  summary["model"]["contrast_gain"] = std::round(sharpening.contrast_gain * 1000) / 1000;
  return begun;
}

/// Returns the share of the last frame in which structure counts.
double counting_share(const core::FrameSource& source) {
  const cv::Mat mask = core::mask_of(source);
  return mask.empty() ? 1 : static_cast<double>(cv::countNonZero(mask)) / static_cast<double>(mask.total());
}

Pictures write_pictures(core::FrameSource& source, const pipeline::Analysis& found,
                        const AnalyzeOptions& options, io::OutputFolder& output, Session& session) {
  Pictures pictures =
      draw_pictures(source, found.motion, found.events, options.reconstruction, output, session);
  if (pictures.not_converged > 0)
    session.warn("the fill stopped before its tolerance in " + std::to_string(pictures.not_converged) +
                 " frames");
  const auto& model = found.model.motion;
  write_png(output, "birth_map.png", draw_rate_map(pictures.mean, birth_map(model), found.events));
  write_png(output, "death_map.png", draw_rate_map(pictures.mean, death_map(model), found.events));
  const cv::Mat trajectories = draw_trajectories(found.motion, found.events);
  write_png(output, "trajectories.png", trajectories);
  pictures.report.trajectories = make_still(trajectories, trajectories.cols, kTrajectoryBytes);
  return pictures;
}

}  // namespace

void write_events(io::OutputFolder& output, const pipeline::Analysis& found, const graph::Units& units) {
  output.write("events.json", [&](std::ostream& out) { graph::write_events(out, found.events, units); });
  output.write("events_all.json",
               [&](std::ostream& out) { graph::write_events(out, found.all_events, units); });
  output.write("events.csv", [&](std::ostream& out) { graph::write_events_csv(out, found.events, units); });
}

Analysis analyze_clip(const std::string& name, const AnalyzeOptions& options, io::OutputFolder& output,
                      Session& session, const std::optional<std::vector<graph::Event>>& truth,
                      const std::string& shown_name, const pipeline::AnalysisStages* stages) {
  Analysis made;
  made.clip = shown_name.empty() ? name : shown_name;
  const auto source = open_clip(name, options.read, session);
  std::error_code error;
  const bool has_sketch =
      stages != nullptr && std::filesystem::exists(output.path() / "stages/sketch/columns.json", error);
  if (const auto estimate =
          has_sketch ? std::nullopt : estimate_run(*source, options, session.common.threads)) {
    session.console.say(words_of(*estimate, source->info()));
    session.console.plan(estimate->stages);
  }
  pipeline::AnalyzeOptions asked = static_cast<const pipeline::AnalyzeOptions&>(options);
  const auto& origin = source->info().origin;
  asked.seed = session.common.seed, asked.clip = made.clip;
  asked.keep_sketch = options.jsonl;
  if (asked.review)
    for (auto& one : *asked.review)
      one.event.position = one.event.position - graph::Point{origin.x, origin.y};
  const auto memory = std::make_shared<io::MappedMemory>(output.path());
  made.found = pipeline::analyze(*source, asked, session.context.with_memory(memory), stages);
  const auto& found = made.found;
  made.stages.add(found.stages);
  made.stages.begin("write");
  if (stages != nullptr) made.found.model.footage.reset();  // the run's folder contains it
  core::return_freed_memory();
  if (stages == nullptr) io::write_model(output, "model", to_archive(found.model));
  const auto units = graph::units_of(source->info());
  const auto lives = graph::stroke_lives(found.motion);
  const auto changes = graph::topology_changes(found.motion);
  write_data(output, found, changes, options.jsonl, units);
  output.write("lives.csv", [&](std::ostream& out) { graph::write_lives(out, lives, units); });
  write_drift(output, *source);
  made.stages.begin("pictures");
  made.found.joints = {};
  core::return_freed_memory();
  Pictures pictures = write_pictures(*source, found, options, output, session);
  const auto& asked_events = found.reviewed ? found.reviewed->asked : found.all_events;
  const auto page =
      make_review_page(*source, made.clip, static_cast<int>(found.motion.sketch.frames.size()), asked_events,
                       asked.review.value_or(std::vector<graph::ReviewedEvent>()), session);
  output.write("review.html", [&](std::ostream& out) { out << page; });
  made.stages.end();

  Json summary = begin_summary("analyze", session);
  const auto frames = static_cast<int>(found.motion.sketch.frames.size());
  summary["clip"] = clip_json(made.clip, source->info(), frames);
  summary = analysis_json(found, options, pictures, std::move(summary));
  summary["rates"] = event_rates_json(found.events, found.motion, units, counting_share(*source));
  summary["strokes"] = lives_json(lives, units);
  summary["topology"] = balance_json(found.motion, changes);
  if (found.reviewed) summary["review"] = review_json(*found.reviewed, units);
  if (truth) {
    const graph::ScoreOptions tolerance;
    summary["score"] = score_json(graph::score_events(*truth, found.events, tolerance));
    summary["score"]["tolerance"] = options_json(tolerance);
  }
  summary["files"] = files_json(options, stages != nullptr);
  summary["per_frame"] = per_frame_json(found.motion, found.events);
  made.summary = std::move(summary);
  made.report = std::move(pictures.report);
  return made;
}

void finish_analysis(Analysis& made, io::OutputFolder& output, const Session& session) {
  Json& summary = made.summary;
  end_summary(summary, session, made.stages);
  const auto& found = made.found;
  made.report.clip = made.clip;
  made.report.command_line = session.command_line;
  made.report.version = kVersion;
  made.report.motion = &found.motion;
  made.report.events = found.events;
  made.report.model = &found.model.motion;
  if (found.sampled) {
    made.report.sampled = &*found.sampled;
    made.report.all_events = found.all_events;
    made.report.rates = rates_a_frame(found);
    summary["sampler"] = sampler_json(*found.sampled);
  }
  output.write("report.html", [&](std::ostream& out) { out << make_report(made.report, summary); });
  write_summary(output, summary);
  session.check_stop();
}

}  // namespace emberfold::apps
