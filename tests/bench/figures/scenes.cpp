// SPDX-License-Identifier: Apache-2.0
// Centre lines and junctions of synthetic scenes. Length counts as found within 1.5 px; what lies up to 2σ
// behind a true end is neither right nor wrong.
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <functional>
#include <span>
#include <string>

#include "sketch/extract.hpp"
#include "tests/bench/figures/measures.hpp"

namespace emberfold::figures {

namespace {

constexpr double kAcross = 1.5, kJunction = 3;

/// Right and all, of what is true and of what was found.
struct Counts {
  double true_hit = 0, true_all = 0, found_hit = 0, found_all = 0;
  [[nodiscard]] double recall() const { return true_all > 0 ? true_hit / true_all : 1; }
  [[nodiscard]] double precision() const { return found_all > 0 ? found_hit / found_all : 1; }
};

void add_precision(Counts& counts, std::span<const Segment> found, std::span<const Segment> truth) {
  for (const Sample& s : samples(found)) {
    const bool hit = near(truth, s.position, kAcross);
    if (!hit && behind_an_end(truth, s.position, kAcross)) continue;
    counts.found_all += s.length;
    if (hit) counts.found_hit += s.length;
  }
}

void add_recall(Counts& counts, std::span<const Segment> found, std::span<const Segment> truth,
                cv::Size size) {
  for (const Sample& s : samples(truth)) {
    const Point p = s.position;
    if (p.x < 0 || p.y < 0 || p.x > size.width - 1 || p.y > size.height - 1) continue;
    counts.true_all += s.length;
    if (near(found, p, kAcross)) counts.true_hit += s.length;
  }
}

struct SceneCounts {
  Counts curves, junctions;
  Counts lines;  ///< curves without step edges; only what was found
};

/// Writes the results for other scorers: lists of curve pieces and of junctions.
class Lists {
 public:
  explicit Lists(const std::filesystem::path& folder) {
    if (folder.empty()) return;
    curves_.open(folder / "scene_curves.csv");
    junctions_.open(folder / "scene_junctions.csv");
    curves_ << "scene,frame,ax,ay,bx,by\n";
    junctions_ << "scene,frame,x,y\n";
  }
  void add(const std::string& scene, int frame, std::span<const Segment> found,
           std::span<const Point> meetings) {
    for (const Segment& s : found)
      curves_ << scene << ',' << frame << ',' << s.a.x << ',' << s.a.y << ',' << s.b.x << ',' << s.b.y
              << '\n';
    for (const Point p : meetings) junctions_ << scene << ',' << frame << ',' << p.x << ',' << p.y << '\n';
  }

 private:
  std::ofstream curves_, junctions_;  // closed where there is no folder
};

SceneCounts measure(const Scene& scene, Lists& lists) {
  SceneCounts counts;
  for (const SceneFrame& frame : scene.frames) {
    const graph::AttributeGraph graph = sketch::extract(levels_of(frame.pixels), usual_options());
    const std::vector<Segment> found = pieces(graph, Kind::all);
    add_recall(counts.curves, found, frame.strokes, frame.pixels.size());
    add_precision(counts.curves, found, frame.strokes);
    add_precision(counts.lines, pieces(graph, Kind::lines), frame.strokes);
    const std::vector<Point> meetings = positions(graph, 3);
    const auto pairs = static_cast<double>(pair_off(meetings, frame.junctions, kJunction));
    counts.junctions.true_hit += pairs;
    counts.junctions.found_hit += pairs;
    counts.junctions.true_all += static_cast<double>(frame.junctions.size());
    counts.junctions.found_all += static_cast<double>(meetings.size());
    lists.add(scene.name, frame.number, found, meetings);
  }
  return counts;
}

void add_rows(std::vector<Row>& rows, const std::string& name, double recall, double precision, double lines,
              double junction_recall, double junction_precision) {
  rows.push_back({name + ": curve recall", recall, 3, "", at_least(0.97)});
  rows.push_back({name + ": curve precision", precision, 3, "", at_least(0.95)});
  rows.push_back({name + ": curve precision, lines only", lines, 3, "", {}});
  rows.push_back({name + ": junction recall", junction_recall, 3, "", at_least(0.9)});
  rows.push_back({name + ": junction precision", junction_precision, 3, "", at_least(0.8)});
}

}  // namespace

std::vector<Row> scenes(const Inputs& inputs) {
  const std::vector<Scene> all = read_scenes(inputs.scenes, 0, 5);
  std::vector<Row> rows;
  Lists lists(inputs.dump);
  double sums[5] = {};
  for (const Scene& scene : all) {
    const SceneCounts c = measure(scene, lists);
    const double figures[5] = {c.curves.recall(), c.curves.precision(), c.lines.precision(),
                               c.junctions.recall(), c.junctions.precision()};
    add_rows(rows, "scenes: " + scene.name, figures[0], figures[1], figures[2], figures[3], figures[4]);
    std::ranges::transform(sums, figures, sums, std::plus{});
  }
  for (double& sum : sums) sum /= static_cast<double>(all.size());
  add_rows(rows, "scenes: MEAN", sums[0], sums[1], sums[2], sums[3], sums[4]);
  return rows;
}

}  // namespace emberfold::figures
