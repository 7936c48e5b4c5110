// SPDX-License-Identifier: Apache-2.0
#include "apps/comparison/comparison.hpp"

#include <array>
#include <filesystem>

#include "apps/cli/summary.hpp"
#include "apps/comparison/comparison_json.hpp"
#include "apps/comparison/comparison_words.hpp"
#include "apps/pictures/png.hpp"
#include "apps/units/event_units.hpp"
#include "core/error.hpp"
#include "core/text/format_number.hpp"

namespace emberfold::apps {

using Json = nlohmann::ordered_json;

namespace {

constexpr std::size_t kInRow = 3;  // pictures per row in the report

/// Calls `compare` and rephrases its errors with the clips' names and the files' final names.
template <class Compare>
auto with_names(std::span<const std::string> clips, const io::OutputFolder& output, const Compare& compare) {
  try {
    return compare();
  } catch (const pipeline::ShortClipError& error) {
    throw core::IoError(pipeline::short_clip_text(clips[static_cast<std::size_t>(error.clip)], error.frames));
  } catch (const core::IoError& error) {
    throw core::IoError(output.with_final_name(error.what()));
  }
}

Json model_json(const pipeline::ModelResult& model) {
  return {{"key", model.key},
          {"label", model.label},
          {"parameters", model.parameters},
          {"file", drawn_clip_file(model.key)}};
}

Json with_profile(Json distances, const pipeline::ClipProfile& profile) {
  distances.update(profile_json(profile));
  return distances;
}

Json synthesis_json(const pipeline::ModelComparison& found) {
  Json synthesis = {{"frames", found.drawn_frames}};
  for (const auto& model : found.models)
    synthesis[model.key] = with_profile(distances_json(model.distances), model.drawn);
  synthesis["noise_floor"] = distances_json(found.noise_floor);
  synthesis["source"] = profile_json(found.source);
  return synthesis;
}

/// Tests whether events are equally frequent in both clips: per second where both frame rates are known,
/// otherwise per frame.
Json rate_tests_of(const pipeline::ClipComparison& found, const core::ClipInfo& a, const core::ClipInfo& b) {
  const bool seconds = a.fps_is_known && b.fps_is_known;
  const auto counts = [](const pipeline::ClipProfile& clip) {
    std::vector<double> all;
    for (const double count : clip.strokes->happened) all.push_back(std::round(count));
    return all;
  };
  const double frames_a = found.a.strokes->frames - 1, frames_b = found.b.strokes->frames - 1;
  Json tests = rate_tests_json(counts(found.a), seconds ? frames_a / a.fps : frames_a, counts(found.b),
                               seconds ? frames_b / b.fps : frames_b);
  tests["per"] = seconds ? "second" : "frame";
  return tests;
}

void finish_measures(Json& measures, io::OutputFolder& output, const Session& session) {
  measures["words"] = comparison_words(measures);
  measures["warnings"] = session.warnings;
  write_measures(measures, output);
}

}  // namespace

Comparison compare_clip(core::FrameSource& source, const std::string& clip,
                        const pipeline::CompareOptions& options, const pipeline::KnownModels& known,
                        io::OutputFolder& output, Session& session) {
  ComparisonFilms films(output, {}, kInRow);
  const auto found = with_names(std::span(&clip, 1), output, [&] {
    auto result = pipeline::compare_models(source, options, known, session.common.seed, session.context,
                                           films.observer());
    films.finish();
    return result;
  });
  Comparison comparison;
  comparison.files = {"measures.json", "side_by_side.mp4", "contact_sheet.png"};
  Json& measures = comparison.measures = begin_measures(found.scale);
  measures["clip"] = clip_json(clip, source.info(), found.frames);
  measures["seed"] = session.common.seed;
  measures["learned_frames"] = found.learned_frames;
  measures["models"] = Json::array();
  NamedCurves curves{{"source", &found.source.curves}};
  for (const auto& model : found.models) {
    measures["models"].push_back(model_json(model));
    curves.emplace_back(model.key, &model.drawn.curves);
    comparison.files.push_back(drawn_clip_file(model.key));
  }
  measures["prediction"] = found.prediction ? prediction_json(*found.prediction) : Json(nullptr);
  if (found.prediction) measures["reconstruction"] = reconstruction_json(*found.prediction);
  measures["synthesis"] = synthesis_json(found);
  measures["curves"] = curves_json(curves, found.scale);
  finish_measures(measures, output, session);
  comparison.pictures = films.take_pictures();
  write_png(output, "contact_sheet.png", comparison.sheet = films.contact_sheet());
  return comparison;
}

Comparison compare_clips(core::FrameSource& a, const std::string& name_a, core::FrameSource& b,
                         const std::string& name_b, const pipeline::CompareOptions& options,
                         io::OutputFolder& output, Session& session) {
  const std::array names{name_a, name_b};
  const auto label = [](const std::string& name) { return std::filesystem::path(name).filename().string(); };
  ComparisonFilms films(output, {label(name_a), label(name_b)}, 2);
  const auto found = with_names(names, output, [&] {
    auto result = pipeline::compare(a, b, options, session.context, films.observer());
    films.finish();
    return result;
  });
  Json measures = begin_measures(found.scale);
  measures["clip"] = clip_json(name_a, a.info(), found.frames_a);
  measures["other"] = clip_json(name_b, b.info(), found.frames_b);
  measures["distances"] = {{"other", with_profile(distances_json(found.distances), found.b)},
                           {"noise_floor", distances_json(found.noise_floor)},
                           {"source", profile_json(found.a)}};
  measures["psnr"] = rounded_or_null(found.psnr);
  measures["ssim"] = rounded_or_null(found.ssim);
  if (found.a.strokes && found.b.strokes) measures["rate_tests"] = rate_tests_of(found, a.info(), b.info());
  if (!found.psnr) measures["psnr_missing"] = found.no_psnr_reason;
  measures["curves"] = curves_json({{"source", &found.a.curves}, {"other", &found.b.curves}}, found.scale);
  finish_measures(measures, output, session);
  const cv::Mat sheet = films.contact_sheet();
  write_png(output, "contact_sheet.png", sheet);
  return {std::move(measures),
          {"measures.json", "side_by_side.mp4", "contact_sheet.png"},
          films.take_pictures(),
          sheet};
}

}  // namespace emberfold::apps
