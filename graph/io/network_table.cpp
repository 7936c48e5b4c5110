// SPDX-License-Identifier: Apache-2.0
#include "graph/io/network_table.hpp"

#include <numeric>
#include <ostream>
#include <string>

#include "graph/io/table_text.hpp"

namespace emberfold::graph {

namespace {

struct MeshSizes {
  double mean = 0, median = 0;  ///< px²; 0 without meshes
};

MeshSizes mesh_sizes(const std::vector<double>& meshes) {
  if (meshes.empty()) return {};
  const std::size_t n = meshes.size();
  const double sum = std::accumulate(meshes.begin(), meshes.end(), 0.0);
  return {sum / static_cast<double>(n), (meshes[(n - 1) / 2] + meshes[n / 2]) / 2};
}

void add_row(std::string& text, std::uint32_t t, const NetworkFigures& f, const NetworkChanges& changes,
             const Units& units) {
  detail::TableLine line(text, units);
  const MeshSizes sizes = mesh_sizes(f.meshes);
  line.add(t);
  line.add(f.length), line.add(f.components), line.add(f.longest);
  for (const auto count : {f.points, f.tips, f.junctions_3, f.junctions_4, f.junctions_more, f.branches,
                           f.loops, static_cast<std::uint32_t>(f.meshes.size())})
    line.add(count);
  line.add(sizes.mean), line.add(sizes.median), line.add(f.tortuosity);
  for (const auto count : {changes.births, changes.deaths, changes.unions, changes.separations})
    line.add(count);
  line.add_time(static_cast<int>(t));
  if (units.um) {
    const double um = *units.um;
    for (const double value : {f.length * um, f.longest * um, sizes.mean * um * um, sizes.median * um * um})
      line.add(value);
  }
  line.end();
}

}  // namespace

void write_network(std::ostream& out, const MotionGraph& motion, const Units& units) {
  std::string text =
      "frame,length,components,longest,points,tips,junctions_3,junctions_4,junctions_more,branches,loops,"
      "meshes,"
      "mesh_mean,mesh_median,tortuosity,births,deaths,unions,separations";
  detail::end_head(text, units, ",time_s", ",length_um,longest_um,mesh_mean_um2,mesh_median_um2");
  const auto changes = network_changes(motion);
  for (std::uint32_t t = 0; t < changes.size(); ++t)
    add_row(text, t, network_figures(motion.sketch.frames[t]), changes[t], units);
  detail::write_table(out, text);
}

}  // namespace emberfold::graph
