// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/block_courses.hpp"

#include <utility>

namespace emberfold::dytex::detail {

namespace {

// Returns, on a torus, the offset of a pixel from a block's corner, in the direction that is shorter.
int offset_in(int pixel, int begin, int length, int around) {
  int offset = (pixel - begin) % around;
  if (offset < 0) offset += around;
  return offset > (around + length) / 2 ? offset - around : offset;
}

}  // namespace

BlockCourses::BlockCourses(cv::Size size, bool wraps, std::vector<PlacedBlock> placed,
                           std::vector<std::int32_t> shown)
    : size_(size),
      wraps_(wraps),
      placed_(std::move(placed)),
      first_(std::move(shown)),
      later_(first_.size()) {}

SourcePixel BlockCourses::source_of(std::int32_t block, cv::Point pixel) const {
  const PlacedBlock& there = placed_[static_cast<std::size_t>(block)];
  const cv::Rect& place = there.place;
  const cv::Point offset = wraps_ ? cv::Point(offset_in(pixel.x, place.x, place.width, size_.width),
                                              offset_in(pixel.y, place.y, place.height, size_.height))
                                  : pixel - place.tl();
  return {there.from.source, there.from.x + offset.x, there.from.y + offset.y};
}

void BlockCourses::read(cv::Point pixel, std::span<const int> begins, std::span<std::int32_t> blocks) const {
  const std::size_t i = index(pixel);
  std::int32_t block = first_[i];
  auto next = later_[i].begin();
  for (std::size_t q = 0; q < begins.size(); ++q) {
    for (; next != later_[i].end() && next->frame <= begins[q]; ++next) block = next->block;
    blocks[q] = block;
  }
}

void BlockCourses::write(cv::Point pixel, std::span<const int> begins, std::span<const std::int32_t> blocks) {
  const std::size_t i = index(pixel);
  first_[i] = blocks.front();
  std::vector<BlockChange> later;
  for (std::size_t q = 1; q < begins.size(); ++q)
    if (blocks[q] != blocks[q - 1]) later.push_back({begins[q], blocks[q]});
  later_[i] = std::move(later);
}

QuiltMap BlockCourses::map(int frames) const {
  QuiltMap map{size_, {}};
  std::size_t i = 0;
  for (int y = 0; y < size_.height; ++y)
    for (int x = 0; x < size_.width; ++x, ++i) {
      map.pixels.push_back(source_of(first_[i], {x, y}));
      for (const auto& change : later_[i]) {
        const SourcePixel from = source_of(change.block, {x, y});
        map.changes.push_back({change.frame, from});
      }
      map.change_ends.push_back(map.changes.size());
    }
  if (map.changes.empty()) map.change_ends.clear();
  map.frames = map.changes.empty() ? 0 : frames;
  return map;
}

}  // namespace emberfold::dytex::detail
