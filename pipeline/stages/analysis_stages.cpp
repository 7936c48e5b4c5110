// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/analysis_stages.hpp"

#include <cstdint>
#include <span>
#include <system_error>
#include <utility>
#include <variant>

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/fingerprint.hpp"
#include "core/io/column_folder.hpp"
#include "core/io/model_folder.hpp"
#include "core/text/json_reader.hpp"
#include "pipeline/stages/graph_columns.hpp"

namespace emberfold::pipeline {

namespace fs = std::filesystem;

namespace {

constexpr const char* kParts = "sketch_parts";
constexpr std::size_t kLeastFrames = 2;  // a shorter clip is an error, and nothing of it is stored

io::Columns sketch_columns(const std::string& key, const SketchedClip& clip, std::size_t first) {
  io::Columns columns{key, {}, {}};
  add_graphs(columns, std::span(clip.sketch.frames).subspan(first));
  add_grounds(columns, std::span(clip.grounds).subspan(first));
  return columns;
}

/// Appends the frames in columns; returns false where they are damaged.
bool append_sketch(SketchedClip& clip, const io::Columns& columns, const core::Context& context) {
  try {
    const auto graphs = read_graphs(columns, context.memory());
    auto grounds = read_grounds(columns);
    if (graphs.size() != grounds.size()) return false;
    for (const auto& graph : graphs) clip.sketch.append(graph);
    for (auto& ground : grounds) clip.grounds.push_back(std::move(ground));
    return true;
  } catch (const core::IoError&) {
    return false;
  }
}

void set_size(SketchedClip& clip, const core::ClipInfo& info) {
  clip.sketch.width = info.width, clip.sketch.height = info.height, clip.sketch.fps = info.fps;
}

constexpr std::size_t kJoint = 7, kEvent = 5;

void add_joints(io::Columns& columns, const std::vector<graph::CurveJoint>& joints) {
  std::vector<double> rows;
  for (const auto& j : joints)
    rows.insert(rows.end(), {double(j.frame), j.position.x, j.position.y, double(j.a.value),
                             double(j.b.value), j.probability, j.at_junction ? 1. : 0.});
  columns.arrays["joints"] = {{joints.size(), kJoint}, false, std::move(rows)};
}

/// Adds events, and their strokes as rows (event, 0 before or 1 after, stroke).
void add_events(io::Columns& columns, const std::vector<graph::Event>& events) {
  std::vector<double> rows;
  std::vector<std::int64_t> strokes;
  for (std::size_t i = 0; i < events.size(); ++i) {
    const auto& e = events[i];
    rows.insert(rows.end(), {double(e.frame), double(static_cast<int>(e.type)), e.position.x, e.position.y,
                             e.probability});
    for (const auto& [side, list] : {std::pair(0, &e.before), std::pair(1, &e.after)})
      for (const auto& stroke : *list)
        strokes.insert(strokes.end(), {static_cast<std::int64_t>(i), side, stroke.value});
  }
  columns.arrays["events"] = {{events.size(), kEvent}, false, std::move(rows)};
  columns.arrays["event_strokes"] = {{strokes.size() / 3, 3}, false, std::move(strokes)};
}

/// Adds how the sampler ran: its moves and traces, chain after chain.
void add_sampled(io::Columns& columns, nlohmann::json& text, const mcmc::SamplerRun& run) {
  auto& sampled = text["sampled"] = {{"chains", run.chains}, {"burn_in", run.burn_in}};
  sampled["moves"] = nlohmann::json::array(), sampled["traces"] = nlohmann::json::array();
  for (const auto& move : run.moves) sampled["moves"].push_back({move.name, move.tried, move.accepted});
  std::vector<double> draws;
  for (const auto& trace : run.traces) {
    sampled["traces"].push_back(trace.name);
    for (const auto& chain : trace.chains) draws.insert(draws.end(), chain.begin(), chain.end());
  }
  columns.arrays["sampled"] = {{draws.size()}, false, std::move(draws)};
}

template <class Value>
const std::vector<Value>& rows_of(const io::Columns& columns, const char* name, std::size_t row) {
  const auto& data = std::get<std::vector<Value>>(columns.arrays.at(name).data);
  if (data.size() % row != 0) throw core::IoError("a column is cut off");
  return data;
}

std::vector<graph::CurveJoint> read_joints(const io::Columns& columns) {
  const auto& rows = rows_of<double>(columns, "joints", kJoint);
  const auto curve = [](double value) { return graph::CurveId{static_cast<std::uint32_t>(value)}; };
  std::vector<graph::CurveJoint> joints;
  joints.reserve(rows.size() / kJoint);
  for (std::size_t i = 0; i < rows.size(); i += kJoint)
    joints.push_back({static_cast<int>(rows[i]),
                      {rows[i + 1], rows[i + 2]},
                      curve(rows[i + 3]),
                      curve(rows[i + 4]),
                      rows[i + 5],
                      rows[i + 6] != 0});
  return joints;
}

std::vector<graph::Event> read_events(const io::Columns& columns) {
  const auto& rows = rows_of<double>(columns, "events", kEvent);
  const auto& strokes = rows_of<std::int64_t>(columns, "event_strokes", 3);
  std::vector<graph::Event> events;
  for (std::size_t i = 0; i < rows.size(); i += kEvent)
    events.push_back({static_cast<int>(rows[i]),
                      static_cast<graph::EventType>(static_cast<int>(rows[i + 1])),
                      {rows[i + 2], rows[i + 3]},
                      rows[i + 4],
                      {},
                      {}});
  for (std::size_t i = 0; i < strokes.size(); i += 3) {
    auto& event = events.at(static_cast<std::size_t>(strokes[i]));
    auto& side = strokes[i + 1] == 0 ? event.before : event.after;
    side.push_back({static_cast<std::uint32_t>(strokes[i + 2])});
  }
  return events;
}

std::optional<mcmc::SamplerRun> read_sampled(const io::Columns& columns, const nlohmann::json& text) {
  if (!text.contains("sampled")) return std::nullopt;
  const auto& sampled = text.at("sampled");
  const auto& draws = rows_of<double>(columns, "sampled", 1);
  mcmc::SamplerRun run{sampled.at("chains"), sampled.at("burn_in"), {}, {}};
  for (const auto& move : sampled.at("moves")) run.moves.push_back({move.at(0), move.at(1), move.at(2)});
  const auto& names = sampled.at("traces");
  const std::size_t chains = static_cast<std::size_t>(run.chains) * names.size();
  if (chains == 0 || draws.size() % chains != 0) throw core::IoError("a column is cut off");
  auto at = draws.begin();
  for (const auto& name : names) {
    mcmc::Trace& trace = run.traces.emplace_back(mcmc::Trace{name, {}});
    for (int c = 0; c < run.chains; ++c) {
      const auto begin = std::exchange(at, at + static_cast<std::ptrdiff_t>(draws.size() / chains));
      trace.chains.emplace_back(begin, at);
    }
  }
  return run;
}

nlohmann::json learned_json(const LearnedModel& learned) {
  auto rates = nlohmann::json::array();
  for (const auto& rate : learned.rates) rates.push_back({rate.mean, rate.low, rate.high});
  return {{"rates", rates}, {"notes", learned.notes}};
}

void read_learned(const nlohmann::json& text, LearnedModel& learned) {
  for (std::size_t i = 0; i < learned.rates.size(); ++i) {
    const auto& rate = text.at("rates").at(i);
    learned.rates[i] = {rate.at(0), rate.at(1), rate.at(2)};
  }
  learned.notes = text.at("notes").get<std::vector<std::string>>();
}

/// Returns a fingerprint of the stored model; what was stored with it applies to this model alone.
std::string model_mark(const core::ModelArchive& archive) {
  return core::Fingerprint().add(archive.text).text();
}

}  // namespace

AnalysisStages::AnalysisStages(fs::path run, StageKeys keys)
    : run_(std::move(run)), folder_(run_ / "stages"), keys_(std::move(keys)) {}

SketchedClip AnalysisStages::read_parts(int* parts, const core::Context& context) const {
  SketchedClip clip;
  for (*parts = 0;; ++*parts) {
    const auto columns = io::read_columns(folder_ / kParts / std::to_string(*parts), keys_.sketch);
    if (!columns || !append_sketch(clip, *columns, context)) return clip;
  }
}

SketchedClip AnalysisStages::sketch(core::FrameSource& source, const sketch::ExtractOptions& options,
                                    const core::Context& context) const {
  std::error_code ignored;
  if (const auto whole = io::read_columns(folder_ / "sketch", keys_.sketch)) {
    SketchedClip clip;
    if (append_sketch(clip, *whole, context)) {
      set_size(clip, source.info());
      return clip;
    }
  }
  int parts = 0;
  auto begun = read_parts(&parts, context);
  if (parts == 0) fs::remove_all(folder_ / kParts, ignored);
  auto clip = sketch_clip(source, options, context, std::move(begun),
                          [&](const SketchedClip& made, std::size_t first) {
                            if (made.grounds.size() < kLeastFrames) return;
                            io::write_columns(folder_ / kParts / std::to_string(parts++),
                                              sketch_columns(keys_.sketch, made, first));
                          });
  if (clip.grounds.size() < kLeastFrames) return clip;
  io::ColumnWriter writer(folder_ / "sketch");
  write_graphs(writer, clip.sketch, clip.grounds, {});
  writer.finish(keys_.sketch, {});
  fs::remove_all(folder_ / kParts, ignored);
  return clip;
}

std::optional<FoundMotion> AnalysisStages::read_motion(const core::Context& context) const {
  const auto columns = io::read_columns(folder_ / "motion", keys_.motion);
  if (!columns) return std::nullopt;
  try {
    FoundMotion found;
    found.motion.sketch.frames = read_graphs(*columns, context.memory());
    found.motion.links = read_links(*columns);
    const auto text = nlohmann::json::parse(columns->text);
    found.motion.sketch.width = text.at("width"), found.motion.sketch.height = text.at("height");
    found.motion.sketch.fps = text.at("fps");
    found.cuts = text.at("cuts").get<std::vector<int>>();
    graph::validate(found.motion);
    found.joints = read_joints(*columns);
    found.all_events = read_events(*columns);
    found.sampled = read_sampled(*columns, text);
    return found;
  } catch (const std::exception&) {  // a damaged file of any kind is computed again
    return std::nullopt;
  }
}

void AnalysisStages::keep_motion(const FoundMotion& found) const {
  const auto& sketch = found.motion.sketch;
  nlohmann::json text = {
      {"width", sketch.width}, {"height", sketch.height}, {"fps", sketch.fps}, {"cuts", found.cuts}};
  io::ColumnWriter writer(folder_ / "motion");
  write_graphs(writer, sketch, {}, found.motion.links);
  io::Columns columns;
  add_joints(columns, found.joints);
  add_events(columns, found.all_events);
  if (found.sampled) add_sampled(columns, text, *found.sampled);
  writer.append(columns.arrays);
  writer.finish(keys_.motion, text.dump());
}

std::optional<LearnedModel> AnalysisStages::read_model() const {
  const auto columns = io::read_columns(folder_ / "model", keys_.model);
  if (!columns) return std::nullopt;
  try {
    const auto text = nlohmann::json::parse(columns->text);
    const auto archive = io::read_model(run_ / "model", io::kMotionFormat);
    if (text.at("model") != model_mark(archive)) return std::nullopt;
    LearnedModel learned{clip_model(archive), {}, {}};
    read_learned(text, learned);
    return learned;
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

void AnalysisStages::keep_model(const LearnedModel& learned) const {
  const auto archive = to_archive(learned.model);
  io::write_model(run_ / "model", archive);
  auto text = learned_json(learned);
  text["model"] = model_mark(archive);
  io::write_columns(folder_ / "model", {keys_.model, text.dump(), {}});
}

}  // namespace emberfold::pipeline
