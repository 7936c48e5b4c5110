// SPDX-License-Identifier: Apache-2.0
#include "dytex/surface/surface_canvas.hpp"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <set>
#include <utility>

#include "dytex/surface/edge_crossing.hpp"

namespace emberfold::dytex::detail {

namespace {

// The texels of charts, the chart with most of them first, each row by row.
std::vector<std::int32_t> texels_by_chart(const SurfaceLayout& layout) {
  const auto charts = static_cast<std::size_t>(layout.chart_count);
  std::vector<std::size_t> count(charts), rank(charts), begin(charts);
  const auto chart_of = [&](std::size_t texel) {
    return static_cast<std::size_t>(layout.charts[static_cast<std::size_t>(layout.triangles[texel])]);
  };
  for (std::size_t i = 0; i < layout.triangles.size(); ++i)
    if (layout.triangles[i] >= 0) ++count[chart_of(i)];
  std::iota(rank.begin(), rank.end(), std::size_t{0});
  std::ranges::stable_sort(rank, std::ranges::greater{}, [&](std::size_t chart) { return count[chart]; });
  std::size_t texels = 0;
  for (const std::size_t chart : rank) begin[chart] = std::exchange(texels, texels + count[chart]);
  std::vector<std::int32_t> order(texels);
  for (std::size_t i = 0; i < layout.triangles.size(); ++i)
    if (layout.triangles[i] >= 0) order[begin[chart_of(i)]++] = static_cast<std::int32_t>(i);
  return order;
}

// Returns the width of the rim that a block at a border has to fit.
int rim_of(cv::Size block) {
  return std::max(1, std::min(block.width, block.height) / 6);
}

}  // namespace

SurfaceCanvas::SurfaceCanvas(const SurfaceLayout& layout, std::span<const QuiltSource> sources,
                             const QuiltOptions& options)
    : layout_(layout),
      sources_(sources),
      options_(options),
      finder_(layout),
      neighbours_(layout),
      order_(texels_by_chart(layout)),
      pixels_(layout.triangles.size()),
      blocks_(layout.triangles.size(), -1) {
  for (const auto& source : sources) courses_.push_back(source.trajectories);
}

std::int64_t SurfaceCanvas::empty_texels(const BlockRegion& region) const {
  return std::ranges::count_if(region.texels, [&](const auto& one) { return !is_filled(one.texel); });
}

std::optional<SurfacePlace> SurfaceCanvas::next() {
  while (next_ < order_.size() && is_filled(order_[next_])) ++next_;
  if (next_ == order_.size()) return next_joint();
  const cv::Size block = options_.block;
  const int overlap = options_.overlap;
  auto left = finder_.find(order_[next_], {overlap, overlap}, block);
  auto right = finder_.find(order_[next_], {block.width - 1 - overlap, overlap}, block);
  return SurfacePlace{empty_texels(right) > empty_texels(left) ? std::move(right) : std::move(left), false};
}

// Returns what earlier blocks show in a cell. Where texels are larger than cells, that is next to the pixel
// that its texel shows.
SourcePixel SurfaceCanvas::shown(const BlockRegion& region, std::int32_t cell) const {
  const auto texel = static_cast<std::size_t>(region.nearest[static_cast<std::size_t>(cell)]);
  const SourcePixel& from = pixels_[texel];
  const cv::Point own = nearest_texel(region.cell_of(layout_.texel(texel)));
  const cv::Point at = cv::Point(from.x, from.y) + region.cell(cell) - own;
  const cv::Size size = sources_[static_cast<std::size_t>(from.source)].trajectories->size();
  return cv::Rect({}, size).contains(at) ? SourcePixel{from.source, at.x, at.y} : from;
}

std::vector<SurfaceCanvas::Met> SurfaceCanvas::meet(const BlockRegion& region) const {
  const auto beyond = neighbours_.texels_beyond(region, options_.overlap);
  std::vector<Met> met(region.nearest.size());
  for (std::size_t i = 0; i < met.size(); ++i) {
    const std::int32_t own = region.nearest[i];
    if (is_filled(own))
      met[i] = {shown(region, static_cast<std::int32_t>(i)), blocks_[static_cast<std::size_t>(own)], false};
    else if (own < 0 && is_filled(beyond[i]))
      met[i] = {pixels_[static_cast<std::size_t>(beyond[i])], blocks_[static_cast<std::size_t>(beyond[i])],
                true};
  }
  return met;
}

// Returns corners of the blocks that are met, and of those that these met. A block at nearly the place of an
// earlier one may continue it.
std::vector<SourcePixel> SurfaceCanvas::places_near(const BlockRegion& region,
                                                    const std::vector<Met>& met) const {
  std::set<std::int32_t> touched, near;
  for (std::size_t i = 0; i < met.size(); ++i) {
    if (met[i].block < 0 || !touched.insert(met[i].block).second) continue;
    const Placed& there = placed_[static_cast<std::size_t>(met[i].block)];
    const cv::Point cell = region.cell(static_cast<std::int32_t>(i));
    const int across = std::abs(met[i].from.x - cell.x - there.corner.x),
              down = std::abs(met[i].from.y - cell.y - there.corner.y);
    if (std::max(across, down) >= options_.apart) near.insert(met[i].block);
  }
  for (const std::int32_t block : touched)
    for (const std::int32_t farther : placed_[static_cast<std::size_t>(block)].touching)
      if (!touched.contains(farther)) near.insert(farther);
  std::vector<SourcePixel> places;
  for (const std::int32_t block : near) places.push_back(placed_[static_cast<std::size_t>(block)].corner);
  return places;
}

BlockQuery SurfaceCanvas::query_of(const BlockRegion& region, const std::vector<Met>& met) const {
  BlockQuery query;
  query.block.column = static_cast<int>(placed_.size());
  query.block.place = {{}, region.block};
  for (int y = 0; y < region.block.height; ++y)
    for (int x = 0; x < region.block.width; ++x) {
      const Met& here = met[static_cast<std::size_t>(region.cell_index({x, y}))];
      if (here.block < 0) continue;
      query.there.push_back(here.from);
      if (!query.runs.empty() && query.runs.back().y == y &&
          query.runs.back().x + query.runs.back().length == x)
        ++query.runs.back().length;
      else
        query.runs.push_back({x, y, 1});
    }
  query.near = places_near(region, met);
  return query;
}

// Returns the cells' states; those next to which earlier blocks continue keep their pixels.
std::vector<CellState> SurfaceCanvas::states(const BlockRegion& region) const {
  std::vector<CellState> states(region.nearest.size(), CellState::outside);
  for (std::size_t i = 0; i < states.size(); ++i)
    if (region.nearest[i] >= 0)
      states[i] = is_filled(region.nearest[i]) ? CellState::there : CellState::empty;
  for (const auto& [texel, cell] : region.rim) {
    CellState& state = states[static_cast<std::size_t>(cell)];
    if (state == CellState::there && is_filled(texel)) state = CellState::held;
  }
  return states;
}

BlockQuery SurfaceCanvas::query(const SurfacePlace& place) const {
  auto met = meet(place.region);
  const cv::Size block = place.region.block;
  const int rim = rim_of(block);
  const cv::Rect inner(rim, rim, block.width - 2 * rim, block.height - 2 * rim);
  for (std::size_t i = 0; place.at_border && i < met.size(); ++i)
    if (!met[i].beyond && inner.contains(place.region.cell(static_cast<std::int32_t>(i)))) met[i] = {};
  return query_of(place.region, met);
}

void SurfaceCanvas::put(const SurfacePlace& place, const SourcePixel& at) {
  const auto& region = place.region;
  const auto met = meet(region);
  auto all = query_of(region, met);
  const cv::Mat picture =
      Overlap(courses_, std::move(all.runs), std::move(all.there)).picture(at, region.block);
  const std::span errors(picture.ptr<double>(), picture.total());
  const auto own = cut_cells(region.block, states(region), errors,
                             place.at_border ? border_costs(region, met, errors) : std::vector<BorderCost>{});
  const auto number = static_cast<std::int32_t>(placed_.size());
  std::set<std::int32_t> touching;
  for (const auto& [texel, cell] : region.texels) {
    std::int32_t& block = blocks_[static_cast<std::size_t>(texel)];
    if (block >= 0) touching.insert(block);
    if (block >= 0 && !own[static_cast<std::size_t>(cell)]) continue;
    if (block < 0) ++filled_;
    const cv::Point step = region.cell(cell);
    block = number;
    pixels_[static_cast<std::size_t>(texel)] = {at.source, at.x + step.x, at.y + step.y};
  }
  touching.erase(number);
  placed_.push_back({at, {touching.begin(), touching.end()}});
}

}  // namespace emberfold::dytex::detail
