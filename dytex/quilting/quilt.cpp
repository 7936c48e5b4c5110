// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/quilt.hpp"

#include <algorithm>
#include <optional>
#include <string>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/text/check_range.hpp"
#include "core/text/size_text.hpp"
#include "dytex/quilting/blocks.hpp"
#include "dytex/quilting/overlap.hpp"
#include "dytex/quilting/quilt_checks.hpp"
#include "dytex/quilting/seam.hpp"
#include "dytex/quilting/seam_surface.hpp"
#include "dytex/quilting/search.hpp"

namespace emberfold::dytex {

void QuiltOptions::validate() const {
  for (const int side : {size.width, size.height})
    if (side < 1 || side > 16384)
      throw core::InputError("QuiltOptions.size is " + core::size_text(size) +
                             "; allowed is 1 to 16384 each way");
  for (const int side : {block.width, block.height})
    if (side < 2 || side > 4096)
      throw core::InputError("QuiltOptions.block is " + core::size_text(block) +
                             "; allowed is 2 to 4096 each way");
  const int most = std::min(block.width, block.height) / 2;
  if (overlap < 1 || overlap > most)
    throw core::InputError("QuiltOptions.overlap is " + std::to_string(overlap) + "; allowed is 1 to " +
                           std::to_string(most) + ", half the shorter side of a block of " +
                           core::size_text(block));
  core::check_range("QuiltOptions.components", components, 1, 256);
  core::check_range("QuiltOptions.tolerance", tolerance, 0, 10);
  core::check_range("QuiltOptions.floor", floor, 0, 255);
  core::check_range("QuiltOptions.apart", apart, 0, 4096);
  core::check_range("QuiltOptions.guide_weight", guide_weight, 0, 0.99);
  if (tileable && std::min(size.width, size.height) < 2 * overlap)
    throw core::InputError("QuiltOptions.size is " + core::size_text(size) +
                           "; tileable output needs at least " + std::to_string(2 * overlap) +
                           " pixels each way, twice the overlap");
}

namespace {

using detail::BlockQuery;
using detail::QuiltBlock;

/// The output during quilting.
class Canvas {
 public:
  explicit Canvas(const detail::BlockPlan& plan)
      : plan_(plan),
        pixels_(static_cast<std::size_t>(plan.canvas.area())),
        owners_(pixels_.size(), -1),
        corners_(static_cast<std::size_t>(plan.columns) * static_cast<std::size_t>(plan.rows)) {}

  [[nodiscard]] std::size_t index(int x, int y) const {
    const int column = x % plan_.canvas.width, row = y % plan_.canvas.height;  // on a torus
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(plan_.canvas.width) +
           static_cast<std::size_t>(column);
  }
  [[nodiscard]] SourcePixel& at(int x, int y) { return pixels_[index(x, y)]; }

  [[nodiscard]] BlockQuery query(const QuiltBlock& block, const cv::Mat& guide) {
    BlockQuery query{block, detail::overlap_runs(block), {}, {}, places_near(block)};
    for (const auto& run : query.runs)
      for (int x = run.x; x < run.x + run.length; ++x)
        query.there.push_back(at(block.place.x + x, block.place.y + run.y));
    if (guide.empty()) return query;
    query.guide.create(block.place.size(), CV_32F);
    for (int y = 0; y < block.place.height; ++y)
      for (int x = 0; x < block.place.width; ++x)
        query.guide.at<float>(y, x) =
            guide.at<float>(place(block.place.y + y, guide.rows), place(block.place.x + x, guide.cols));
    return query;
  }

  /// Returns whether a block from this place would only continue its left or upper neighbour.
  [[nodiscard]] bool goes_on(const QuiltBlock& block, const SourcePixel& from) {
    const auto from_there = [&](int column, int row) {
      const Corner& there = corner(column, row);
      return continues(there.from, from, block.place.tl() - there.at);
    };
    return (block.column > 0 && from_there(block.column - 1, block.row)) ||
           (block.row > 0 && from_there(block.column, block.row - 1));
  }

  void put(const QuiltBlock& block, const SourcePixel& from, const cv::Mat& mask) {
    for (int y = 0; y < block.place.height; ++y)
      for (int x = 0; x < block.place.width; ++x)
        if (mask.at<unsigned char>(y, x) != 0) {
          at(block.place.x + x, block.place.y + y) = {from.source, from.x + x, from.y + y};
          owners_[index(block.place.x + x, block.place.y + y)] = static_cast<std::int32_t>(placed_.size());
        }
    placed_.push_back({block.place, from});
    corner(block.column, block.row) = {from, block.place.tl()};
  }

  [[nodiscard]] QuiltMap map(cv::Size size) {
    QuiltMap map{size, {}};
    map.pixels.reserve(static_cast<std::size_t>(size.area()));
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) map.pixels.push_back(at(x, y));
    return map;
  }

  [[nodiscard]] detail::BlockCourses courses(cv::Size size) const {
    std::vector<std::int32_t> shown;
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) shown.push_back(owners_[index(x, y)]);
    return {size, plan_.wraps, placed_, std::move(shown)};
  }

 private:
  struct Corner {
    SourcePixel from;
    cv::Point at;
  };
  // A guide repeats its border where blocks reach beyond it, or starts again on a torus.
  [[nodiscard]] int place(int i, int size) const { return plan_.wraps ? i % size : std::min(i, size - 1); }
  Corner& corner(int column, int row) {
    return corners_[static_cast<std::size_t>(row) * static_cast<std::size_t>(plan_.columns) +
                    static_cast<std::size_t>(column)];
  }
  // Returns the places of the blocks around that were placed before this one, at any number of threads.
  std::vector<SourcePixel> places_near(const QuiltBlock& block) {
    std::vector<SourcePixel> places;
    for (const cv::Point step :
         {cv::Point(-1, 0), {-2, 0}, {-2, -1}, {-1, -1}, {0, -1}, {1, -1}, {-1, -2}, {0, -2}, {1, -2}}) {
      const cv::Point at(block.column + step.x, block.row + step.y);
      if (at.x >= 0 && at.y >= 0 && at.x < plan_.columns) places.push_back(corner(at.x, at.y).from);
    }
    return places;
  }

  const detail::BlockPlan& plan_;
  std::vector<SourcePixel> pixels_;
  std::vector<std::int32_t> owners_;  // blocks in the order in which they were placed
  std::vector<detail::PlacedBlock> placed_;
  std::vector<Corner> corners_;
};

// Cuts seams between earlier blocks and the chosen block.
cv::Mat cut_block(const detail::BlockSearch& search, const BlockQuery& query, const SourcePixel& at) {
  const cv::Size size = query.block.place.size();
  if (query.there.empty()) return {size, CV_8U, cv::Scalar(255)};
  return detail::block_mask(search.overlap(query).picture(at, size), query.block);
}

}  // namespace

QuiltResult quilt(std::span<const QuiltSource> sources, const QuiltOptions& options,
                  const core::Context& context, const cv::Mat& guide) {
  options.validate();
  detail::check_sources(sources, options, guide);
  const auto plan = detail::plan_blocks(options.size, options.block, options.overlap, options.tileable);
  cv::Size least = options.block, most(1, 1);
  std::size_t blocks = 0;
  for (const auto& wave : plan.waves)
    for (const auto& block : wave) {
      least = {std::min(least.width, block.place.width), std::min(least.height, block.place.height)};
      most = {std::max(most.width, block.place.width), std::max(most.height, block.place.height)};
      ++blocks;
    }
  context.report("basis", 0);
  const detail::BlockSearch search(sources, options, least, most, context);
  Canvas canvas(plan);
  QuiltResult result{{}, {}, plan.columns, plan.rows, search.components()};
  for (const auto& wave : plan.waves) {
    context.check();
    context.report("quilt", static_cast<double>(result.choices.size()) / static_cast<double>(blocks));
    std::vector<QuiltChoice> chosen(wave.size());
    std::vector<cv::Mat> masks(wave.size());
    core::parallel_for(wave.size(), context, [&](std::size_t i) {
      const auto query = canvas.query(wave[i], guide);
      chosen[i] = search.choose(query);
      chosen[i].continues = canvas.goes_on(wave[i], chosen[i].at);
      masks[i] = cut_block(search, query, chosen[i].at);
    });
    for (std::size_t i = 0; i < wave.size(); ++i) canvas.put(wave[i], chosen[i].at, masks[i]);
    result.choices.insert(result.choices.end(), chosen.begin(), chosen.end());
  }
  if (options.seams == Seams::moving) {
    auto courses = canvas.courses(options.size);
    detail::move_seams(courses, sources, context);
    result.map = courses.map(sources.front().trajectories->frames());
  } else {
    result.map = canvas.map(options.size);
  }
  return result;
}

}  // namespace emberfold::dytex
