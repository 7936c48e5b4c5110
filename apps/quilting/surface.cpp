// SPDX-License-Identifier: Apache-2.0
#include "apps/quilting/surface.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "core/io/files.hpp"
#include "core/text/format_number.hpp"
#include "core/text/size_text.hpp"
#include "dytex/surface/surface_measures.hpp"

namespace emberfold::apps {

using Json = nlohmann::ordered_json;

SurfaceFound read_surface(const QuiltRequest& request, Session& session) {
  auto stream = io::open_file(request.surface);
  const auto mesh = dytex::read_obj(stream, request.surface);
  SurfaceFound found;
  try {
    found.layout = dytex::lay_out_surface(mesh, request.quilt.size);
  } catch (const core::InputError& error) {
    throw core::InputError(request.surface + ": " + error.what());
  }
  const auto& layout = found.layout;
  if (layout.hidden_charts > 0)
    session.warn(request.surface + ": " + std::to_string(layout.hidden_charts) + " of " +
                 std::to_string(layout.chart_count) + " charts lie between the texels of " +
                 core::size_text(layout.size) + " and show what is beside them; a larger --size holds them");
  constexpr double kSeen = 0.001;
  const double repeated = static_cast<double>(layout.repeated) / static_cast<double>(layout.covered);
  if (repeated > kSeen)
    session.warn(request.surface + ": faces lie over each other in the texture (" +
                 core::fixed_text(100 * repeated, 1) + " % of its texels) and show the same");
  if (request.control.jitter > 0)
    session.warn("control.jitter is smooth in the texture: where its charts meet on the surface, time jumps");
  return found;
}

dytex::QuiltMap block_map(const SurfaceFound& found) {
  dytex::QuiltMap map{found.layout.size, {}};
  for (std::size_t i = 0; i < found.quilt.blocks.size(); ++i) {
    const cv::Point texel = found.layout.texel(i);
    map.pixels.push_back({found.quilt.blocks[i], texel.x, texel.y});
  }
  return map;
}

Json surface_json(const std::string& mesh, const dytex::SurfaceLayout& layout) {
  return {{"mesh", mesh},
          {"triangles", layout.charts.size()},
          {"charts", layout.chart_count},
          {"hidden_charts", layout.hidden_charts},
          {"glued_edges", layout.glued.size()},
          {"covered", static_cast<double>(layout.covered) / static_cast<double>(layout.size.area())},
          {"repeated", static_cast<double>(layout.repeated) / static_cast<double>(layout.covered)},
          {"pixel", layout.pixel}};
}

Json surface_measures_json(const SurfaceFound& found, std::span<const dytex::Trajectories* const> sources) {
  const auto measures = dytex::measure_surface(found.layout, found.quilt, sources);
  return {{"source_share", measures.source_share},   {"seam_share", measures.seam_share},
          {"seam_step", measures.seam_step},         {"other_step", measures.other_step},
          {"seam_ratio", measures.seam_ratio()},     {"border_step", measures.border_step},
          {"border_ratio", measures.border_ratio()}, {"border_gap", measures.border_gap}};
}

}  // namespace emberfold::apps
