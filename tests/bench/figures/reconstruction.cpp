// SPDX-License-Identifier: Apache-2.0
// Frames of clips from the sketchable part and diffusion, against what else a share of the pixels could be.
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <string>

#include <opencv2/imgcodecs.hpp>

#include "core/parallel.hpp"
#include "graph/attribute_graph.hpp"
#include "sketch/extract.hpp"
#include "sketch/inpainting/anchors.hpp"
#include "sketch/inpainting/fill.hpp"
#include "sketch/rendering/render.hpp"
#include "tests/bench/figures/cpu_time.hpp"
#include "tests/bench/figures/measures.hpp"
#include "tests/bench/figures/rivals.hpp"

namespace emberfold::figures {

namespace {

using sketch::Sketchable;

/// Adds anchors until they and the `cores` of the patches make up the whole share.
graph::AttributeGraph with_anchors(const graph::AttributeGraph& graph, const cv::Mat& levels,
                                   const Sketchable& cores) {
  const double room = std::max(kShare - cores.share(), 0.0);
  return sketch::add_anchors(graph, levels, sketch::choose_anchors(levels, cores, room));
}

/// What `emberfold sketch` draws, with the frame's own pixels and from attributes.
Sketchable pixels(const graph::AttributeGraph& graph, const cv::Mat& levels) {
  Sketchable cores = sketch::draw_cores(graph, levels.size(), levels.channels());
  levels.copyTo(cores.levels, cores.mask);
  return sketch::draw_pixels(with_anchors(graph, levels, cores), levels);
}
Sketchable fitted(const graph::AttributeGraph& graph, const cv::Mat& levels) {
  const Sketchable cores = sketch::draw_cores(graph, levels.size(), levels.channels());
  return sketch::draw_fitted(with_anchors(graph, levels, cores), levels.size(), levels.channels());
}

/// A frame's figures by their names.
using Figures = std::map<std::string, double>;

double filled_psnr(const cv::Mat1b& frame, const cv::Mat& levels, const cv::Mat& mask) {
  return psnr(frame, sketch::fill(levels, mask).levels);
}

/// The frame and the mask of `pixels`, for others to work on, and a line of our own figures.
void dump(const std::filesystem::path& folder, const std::string& name, const cv::Mat1b& frame,
          const cv::Mat& mask, const Figures& figures) {
  cv::imwrite((folder / (name + ".png")).string(), frame);
  cv::imwrite((folder / (name + "_mask.png")).string(), mask);
  const cv::Mat1f levels = levels_of(frame);
  const core::ThreadLimit one(1);
  const double sketching = least_time(3, [&] { sketch::extract(levels, usual_options()); });
  const double filling = least_time(3, [&] { sketch::fill(levels, mask); });
  std::ofstream list(folder / "frames.csv", std::ios::app);
  list << name << ',' << figures.at("share") << ',' << figures.at("pixels") << ',' << figures.at("fitted")
       << ',' << sketching << ',' << filling << '\n';
}

/// "share" of the pixels, PSNR of both ways to draw, and of rivals at the same share.
Figures measure(const ClipFrame& source, const std::filesystem::path& folder) {
  const cv::Mat1b frame = grey_at(source.pixels);
  const cv::Mat1f levels = levels_of(frame);
  const graph::AttributeGraph graph = sketch::extract(levels, usual_options());
  const Sketchable held = pixels(graph, levels), drawn = fitted(graph, levels);
  Figures figures;
  figures["pixels"] = filled_psnr(frame, held.levels, held.mask);
  figures["fitted"] = filled_psnr(frame, drawn.levels, drawn.mask);
  figures["share"] = held.share();
  figures["random"] = filled_psnr(frame, levels, random_mask(frame.size(), figures["share"]));
  const cv::Mat band = canny_band(frame, figures["share"]);
  figures["Canny share"] = share(band);
  figures["Canny"] = filled_psnr(frame, levels, band);
  if (!folder.empty())
    dump(folder, source.clip + "_" + std::to_string(source.number), frame, held.mask, figures);
  return figures;
}

Figures mean(const std::vector<Figures>& all) {
  Figures result;
  for (const Figures& figures : all)
    for (const auto& [name, value] : figures) result[name] += value / static_cast<double>(all.size());
  return result;
}

void add_clip(std::vector<Row>& rows, const std::string& clip, const Figures& figures) {
  for (const auto& [name, value] : figures)
    rows.push_back({"reconstruction: " + clip + ", " + name,
                    name.ends_with("share") ? 100 * value : value,
                    2,
                    name.ends_with("share") ? "%" : "dB",
                    {}});
}

/// Adds the lead of a figure over another: the mean, and the least of all clips.
void add_lead(std::vector<Row>& rows, const std::map<std::string, Figures>& clips, const Figures& all,
              const std::string& name, const std::string& rival, double target) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [clip, figures] : clips) least = std::min(least, figures.at(name) - figures.at(rival));
  const std::string what = "reconstruction: " + name + " above " + rival;
  rows.push_back({what + ", mean", all.at(name) - all.at(rival), 2, "dB", at_least(target)});
  rows.push_back({what + ", least clip", least, 2, "dB", at_least(0)});
}

void add_targets(std::vector<Row>& rows, const std::map<std::string, Figures>& clips, const Figures& all,
                 double greatest_share) {
  rows.push_back({"reconstruction: pixels, greatest share of a frame", 100 * greatest_share, 2, "%",
                  at_most(100 * kShare)});
  add_lead(rows, clips, all, "pixels", "Canny", 3);
  rows.push_back({"reconstruction: fitted below pixels, mean", all.at("pixels") - all.at("fitted"), 2, "dB",
                  at_most(2.5)});
}

}  // namespace

std::vector<Row> reconstruction(const Inputs& inputs) {
  const std::vector<ClipFrame> frames = clip_frames(inputs.clips, {40, 60, 80, 100});
  if (!inputs.dump.empty())
    std::ofstream(inputs.dump / "frames.csv") << "frame,share,pixels_db,fitted_db,sketch_ms,fill_ms\n";
  std::map<std::string, std::vector<Figures>> by_clip;
  double greatest_share = 0;
  for (const ClipFrame& frame : frames) {
    by_clip[frame.clip].push_back(measure(frame, inputs.dump));
    greatest_share = std::max(greatest_share, by_clip[frame.clip].back().at("share"));
  }
  std::map<std::string, Figures> clips;
  std::vector<Figures> all;
  std::vector<Row> rows;
  for (const auto& [clip, figures] : by_clip) {
    clips[clip] = mean(figures);
    all.insert(all.end(), figures.begin(), figures.end());
    add_clip(rows, clip, clips[clip]);
  }
  add_clip(rows, "MEAN", mean(all));
  add_targets(rows, clips, mean(all), greatest_share);
  return rows;
}

}  // namespace emberfold::figures
