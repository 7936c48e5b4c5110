// SPDX-License-Identifier: Apache-2.0
#include "apps/sketching/sketch_dictionary.hpp"

#include <cmath>
#include <ostream>
#include <utility>

#include <nlohmann/json.hpp>

#include "apps/pictures/png.hpp"
#include "apps/sketching/dictionary_picture.hpp"
#include "core/error.hpp"
#include "core/io/model_folder.hpp"
#include "core/text/format_number.hpp"
#include "pipeline/steady_frames.hpp"

namespace emberfold::apps {

namespace {

SketchDictionary learn_dictionary(core::FrameSource& source, const sketch::ExtractOptions& options,
                                  const Session& session) {
  struct Frame {
    graph::AttributeGraph graph;
    std::vector<sketch::PatchView> views;
  };
  SketchDictionary learned;
  sketch::DictionaryLearner learner(session.common.seed);
  pipeline::stream_steady_frames(
      source, "dictionary", options, session.context,
      [&](int, const cv::Mat& levels) {
        return std::vector<pipeline::FrameReading>{{levels, sketch::extract(levels, options)}};
      },
      [&](int, std::vector<pipeline::FrameReading> readings) {
        Frame made{readings.front().graph, {}};
        made.views = sketch::view_patches(readings.front().levels, made.graph);
        return made;
      },
      [&](int t, Frame made) {
        learner.add(static_cast<std::uint32_t>(t), made.views);
        learned.graphs.push_back(std::move(made.graph));
      });
  learned.dictionary = learner.learn(session.context);
  session.check_stop();
  return learned;
}

}  // namespace

std::optional<SketchDictionary> prepare_dictionary(const DictionaryRequest& request,
                                                   core::FrameSource& source,
                                                   const sketch::ExtractOptions& options,
                                                   const Session& session) {
  if (request.learn) return learn_dictionary(source, options, session);
  if (request.folder.empty()) return std::nullopt;
  const auto archive = io::read_model(request.folder, io::kDictionaryFormat);
  try {
    return SketchDictionary{sketch::read_dictionary(archive), {}};
  } catch (const core::IoError& error) {
    throw core::IoError(request.folder + ": " + error.what());
  }
}

std::vector<sketch::PatchCode> encode_frame(const cv::Mat& levels, const graph::AttributeGraph& graph,
                                            const SketchDictionary& dictionary) {
  return sketch::encode(levels, graph, dictionary.dictionary, sketch::estimate_noise(core::luma(levels)));
}

void CodeFigures::add(std::span<const sketch::PatchCode> codes) {
  for (const sketch::PatchCode& code : codes) {
    ++patches_;
    if (code.entry == sketch::PatchCode::kNone) continue;
    cost_ += code.cost;
    parametric_cost_ += code.parametric_cost;
    if (code.parametric) {
      ++profiles_;
      learned_squares_ += code.residual * code.residual;
      parametric_squares_ += *code.parametric * *code.parametric;
    } else {
      ++windows_;
      window_squares_ += code.residual * code.residual;
    }
  }
}

nlohmann::ordered_json CodeFigures::json(const sketch::Dictionary& dictionary) const {
  using Json = nlohmann::ordered_json;
  const auto share = [](double sum, std::size_t count) {
    return count > 0 ? Json(core::round_to(sum / static_cast<double>(count), 3)) : Json(nullptr);
  };
  const auto rms = [](double squares, std::size_t count) {
    return count > 0 ? Json(core::round_to(std::sqrt(squares / static_cast<double>(count)), 3))
                     : Json(nullptr);
  };
  const std::size_t coded = profiles_ + windows_;
  Json entries = Json::array();
  for (const auto& entry : dictionary.entries)
    entries.push_back({{"degree", entry.degree},
                       {"type", graph::name(entry.type)},
                       {"seen", entry.seen},
                       {"share", core::round_to(entry.share, 3)},
                       {"components", entry.components.size()},
                       {"residual", core::round_to(entry.residual, 3)}});
  return {
      {"coded_share", share(static_cast<double>(coded), patches_)},
      {"residual_profiles",
       {{"learned", rms(learned_squares_, profiles_)}, {"parametric", rms(parametric_squares_, profiles_)}}},
      {"residual_windows", {{"learned", rms(window_squares_, windows_)}}},
      {"cost", {{"learned", share(cost_, coded)}, {"parametric", share(parametric_cost_, coded)}}},
      {"entries", std::move(entries)}};
}

void write_dictionary(io::OutputFolder& output, const sketch::Dictionary& dictionary) {
  io::write_model(output, "dictionary", sketch::to_archive(dictionary));
  write_png(output, "dictionary.png", draw_dictionary(dictionary));
}

}  // namespace emberfold::apps
