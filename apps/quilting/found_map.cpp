// SPDX-License-Identifier: Apache-2.0
#include "apps/quilting/found_map.hpp"

#include <cmath>
#include <span>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/io/files.hpp"
#include "dytex/quilting/quilt_measures.hpp"

namespace emberfold::apps {

using Json = nlohmann::ordered_json;

void seek_map(FoundMap& found, const QuiltClips& clips, const QuiltRequest& request, const Session& session) {
  cv::Mat guide;
  const auto sources = quilt_sources(clips, request, guide);
  if (found.surface) {
    auto& quilt = found.surface->quilt;
    quilt = dytex::quilt_surface(found.surface->layout, sources, request.quilt, session.context);
    found.map = quilt.map;
  } else {
    found.result = dytex::quilt(sources, request.quilt, session.context, guide);
    found.map = found.result->map;
  }
}

dytex::QuiltMap read_map(const std::string& name, const std::vector<cv::Size>& sizes) {
  auto stream = io::open_file(name);
  try {
    return dytex::quilt_map(core::read_npy(stream), sizes);
  } catch (const core::IoError& error) {
    throw core::IoError(name + ": " + error.what());
  } catch (const core::InputError& error) {
    throw core::InputError(name + ": " + error.what());
  }
}

namespace {

Json choices_json(std::span<const dytex::QuiltChoice> choices, int components,
                  const std::optional<dytex::QuiltResult>& plane) {
  double compared = 0, equals = 0;
  for (const auto& choice : choices)
    compared += static_cast<double>(choice.compared), equals += static_cast<double>(choice.equals);
  const auto mean = [&](double sum) {
    return std::round(10 * sum / static_cast<double>(choices.size())) / 10;
  };
  Json out = {{"blocks", choices.size()}};
  if (plane) {
    out["columns"] = plane->columns;
    out["rows"] = plane->rows;
  }
  out["components"] = components;
  out["compared_mean"] = mean(compared);
  out["equals_mean"] = mean(equals);
  return out;
}

void add_plane_measures(Json& out, const FoundMap& found, std::span<const dytex::QuiltChoice> choices,
                        std::span<const dytex::Trajectories* const> held) {
  const auto measures = dytex::measure_quilt(found.map, choices, held);
  if (found.result) out["verbatim_blocks"] = measures.verbatim_blocks;
  out["largest_piece"] = measures.largest_piece;
  out["source_share"] = measures.source_share;
  out["seam_share"] = measures.seam_share;
  out["seam_step"] = measures.seam_step;
  out["other_step"] = measures.other_step;
  out["seam_ratio"] = measures.seam_ratio();
  if (!found.map.is_still()) {
    out["change_share"] = measures.change_share;
    out["change_step"] = measures.change_step;
    out["course_step"] = measures.course_step;
    out["change_ratio"] = measures.change_ratio();
  }
}

}  // namespace

Json found_map_json(const FoundMap& found, const QuiltClips& clips) {
  const auto held = clips.loaded();
  if (found.surface) {
    Json out = choices_json(found.surface->quilt.choices, found.surface->quilt.components, {});
    out.update(surface_measures_json(*found.surface, held));
    return out;
  }
  Json out = Json::object();
  std::span<const dytex::QuiltChoice> choices;
  if (found.result) {
    choices = found.result->choices;
    out = choices_json(choices, found.result->components, found.result);
  }
  if (clips.is_loaded()) add_plane_measures(out, found, choices, held);
  return out;
}

}  // namespace emberfold::apps
