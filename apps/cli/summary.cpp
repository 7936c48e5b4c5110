// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/summary.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <numbers>
#include <numeric>

#include "core/text/format_number.hpp"
#include "graph/io/units_json.hpp"

namespace emberfold::apps {

using Json = nlohmann::ordered_json;

Json begin_summary(const std::string& command, const Session& session) {
  return {{"format", "emberfold.summary"},
          {"version", 1},
          {"command", command},
          {"emberfold", kVersion},
          {"command_line", session.command_line},
          {"seed", session.common.seed}};
}

void end_summary(Json& summary, const Session& session, const Stages& stages) {
  summary["warnings"] = session.warnings;
  summary["seconds"] = stages.seconds();
  summary["peak_memory_mb"] = peak_memory_mb();
}

void write_summary(io::OutputFolder& output, const Json& summary) {
  output.write("summary.json", [&](std::ostream& out) { out << json_text(summary); });
}

Json clip_json(const std::string& clip, const core::ClipInfo& info, int frames) {
  Json json = {{"name", clip},
               {"width", info.width},
               {"height", info.height},
               {"channels", info.channels},
               {"fps", info.fps},
               {"frames", frames},
               {"fps_is_known", info.fps_is_known},
               {"pixel_um", info.pixel_um ? Json(*info.pixel_um) : Json(nullptr)},
               {"bits", CV_ELEM_SIZE1(info.depth) * 8},
               {"white", info.white}};
  graph::add_units(json, graph::units_of(info));
  return json;
}

namespace {

Json levels_json(const io::Levels& levels) {
  if (levels.kind == io::Levels::Kind::given) return {levels.low, levels.high};
  return levels.kind == io::Levels::Kind::full ? "full" : "auto";
}

}  // namespace

Json reading_json(const io::ReadOptions& read) {
  Json out = options_json(read);
  out["grey"] = read.grey;
  out["range"] = std::to_string(read.first) + ":" + (read.last ? std::to_string(*read.last) : "");
  out["every"] = read.every;
  out["levels"] = levels_json(read.levels);
  // Only the given options: the default of each is the clip's own value.
  if (const auto& region = read.region) out["roi"] = {region->x, region->y, region->width, region->height};
  if (read.fps) out["fps"] = *read.fps;
  if (read.pixel_size) out["pixel_um"] = *read.pixel_size;
  if (!read.mask.empty()) out["mask"] = read.mask;
  if (read.counts_from_part) out["origin"] = "part";
  if (read.stabilize != io::Stabilize::none) out["stabilize"] = io::name(read.stabilize);
  if (read.channel) out["channel"] = *read.channel;
  if (read.slice) out["slice"] = *read.slice;
  if (read.brightest_slice) out["slice"] = "max";
  return out;
}

void write_drift(io::OutputFolder& output, const core::FrameSource& source) {
  const auto drift = core::drift_of(source);
  if (drift.empty()) return;
  output.write("drift.csv", [&](std::ostream& out) {
    out << "frame,x,y,scale,degrees\n";
    for (std::size_t t = 0; t < drift.size(); ++t) {
      const auto& motion = drift[t];
      out << t;
      for (const double value : {motion.x, motion.y, motion.scale, motion.angle * 180 / std::numbers::pi})
        out << ',' << core::fixed_text(value, 5);
      out << '\n';
    }
  });
}

Json score_json(const graph::Score& score) {
  const auto classes = [](const std::vector<graph::ClassScore>& list) {
    Json out = Json::object();
    for (const auto& s : list)
      out[s.name] = {{"true", s.in_truth},         {"found", s.found},     {"hit", s.hit},
                     {"precision", s.precision()}, {"recall", s.recall()}, {"f1", s.f1()}};
    return out;
  };
  return {{"four", classes(score.four)}, {"six", classes(score.six)}};
}

std::string score_table(const graph::Score& score) {
  std::string out;
  const auto table = [&](const char* reading, const std::vector<graph::ClassScore>& list) {
    out += std::string(reading) + " classes            true found   hit  precision  recall     F1\n";
    for (const auto& s : list) {
      std::array<char, 128> line{};
      std::snprintf(line.data(), line.size(), "  %-20s%5zu %5zu %5zu  %9.3f %7.3f %6.3f\n", s.name.c_str(),
                    s.in_truth, s.found, s.hit, s.precision(), s.recall(), s.f1());
      out += line.data();
    }
  };
  table("four", score.four);
  table("six", score.six);
  return out;
}

Json spread_json(std::span<const double> values) {
  if (values.empty()) return nullptr;
  const auto [low, high] = std::ranges::minmax_element(values);
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  return {{"mean", core::round_to(sum / static_cast<double>(values.size()), 3)},
          {"min", core::round_to(*low, 3)},
          {"max", core::round_to(*high, 3)},
          {"frames", values.size()}};
}

std::string json_text(const Json& value) {
  return value.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace emberfold::apps
