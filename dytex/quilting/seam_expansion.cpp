// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/seam_expansion.hpp"

#include <algorithm>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace emberfold::dytex::detail {

namespace {

constexpr std::int64_t kSmooth = 1;  // cost of a value at a seam where nothing differs: half a squared level
constexpr std::int64_t kMostCost = 1 << 27;  // of a pair; a node has at most six
constexpr std::int64_t kWhite = (255LL * kValuesPerLevel * 255 * kValuesPerLevel) >> 7;

/// Costs of a pair whose nodes keep what they show (old) or take the block (new).
struct PairCosts {
  std::int32_t old_old, old_new, new_old;
};

// Adds a pair to a cut whose second side takes the block; −1 for a pixel that is not a node and keeps its
// block.
void add_pair(core::MinimumCut& cut, std::int32_t s, std::int32_t t, const PairCosts& cost) {
  const auto i = static_cast<std::size_t>(s), j = static_cast<std::size_t>(t);
  if (t < 0) {
    cut.add_costs(i, cost.old_old, cost.new_old);
  } else if (s < 0) {
    cut.add_costs(j, cost.old_old, cost.old_new);
  } else if (cost.old_new >= cost.old_old) {
    cut.add_costs(i, cost.old_old, 0);
    cut.add_edge(i, j, cost.old_new - cost.old_old, cost.new_old);
  } else {
    // A cut cannot express an existing seam that costs more than both new ones: the new ones are then made
    // dearer.
    cut.add_costs(i, cost.old_new, 0);
    cut.add_costs(j, cost.old_old - cost.old_new, 0);
    cut.add_edge(i, j, 0, std::max(0, cost.new_old + cost.old_new - cost.old_old));
  }
}

}  // namespace

SeamExpansion::SeamExpansion(const BlockCourses& courses, const CourseValues& values,
                             const SeamWindow& window, std::int32_t block, const SpanBegins& begins)
    : courses_(courses),
      values_(values),
      place_(window.place),
      block_(block),
      begins_(begins),
      spans_(begins.size()),
      course_(static_cast<std::size_t>(values.frames()) * values.channels()) {
  int longest = 0;
  for (std::size_t q = 0; q < spans_; ++q) longest = std::max(longest, end(q) - begins_[q]);
  unit_ = 1 + longest * static_cast<std::int64_t>(values.channels()) * kWhite / kMostCost;
  shown_.resize(pixels() * spans_);
  for (std::size_t p = 0; p < pixels(); ++p)
    courses.read(pixel(p), begins, std::span(shown_).subspan(p * spans_, spans_));
  find_nodes(window.band);
  find_slots();
}

cv::Point SeamExpansion::pixel(std::size_t p) const {
  const cv::Point at(place_.x + static_cast<int>(p % width()), place_.y + static_cast<int>(p / width()));
  const cv::Size size = courses_.size();
  return {(at.x + size.width) % size.width, (at.y + size.height) % size.height};
}

int SeamExpansion::end(std::size_t span) const {
  return span + 1 < spans_ ? begins_[span + 1] : values_.frames();
}

// Returns the pixels that the block may take. Those at the window's border keep their block, as their
// neighbours outside are not considered; at the output's border there are none.
std::vector<bool> SeamExpansion::open_pixels() const {
  const cv::Size size = courses_.size();
  const bool flat = !courses_.wraps();
  const int left = flat && place_.x == 0 ? 0 : 1, top = flat && place_.y == 0 ? 0 : 1;
  const int right = flat && place_.br().x == size.width ? 0 : 1,
            bottom = flat && place_.br().y == size.height ? 0 : 1;
  std::vector<bool> open(pixels(), false);
  for (int y = top; y < place_.height - bottom; ++y)
    for (int x = left; x < place_.width - right; ++x) {
      const std::size_t p = static_cast<std::size_t>(y) * width() + static_cast<std::size_t>(x);
      open[p] = values_.may_show(courses_.source_of(block_, pixel(p)));
    }
  return open;
}

void SeamExpansion::find_nodes(int band) {
  node_.assign(pixels() * spans_, -1);
  const auto open = open_pixels();
  const cv::Mat around = cv::Mat::ones(2 * band + 1, 2 * band + 1, CV_8U);
  cv::Mat own(place_.size(), CV_8U), near(place_.size(), CV_8U, cv::Scalar(1));
  for (std::size_t q = 0; q < spans_; ++q) {
    auto* mine = own.ptr<unsigned char>();
    for (std::size_t p = 0; p < pixels(); ++p) mine[p] = shown_[p * spans_ + q] == block_ ? 1 : 0;
    if (band > 0) cv::dilate(own, near, around);
    const auto* reached = near.ptr<unsigned char>();
    for (std::size_t p = 0; p < pixels(); ++p)
      if (open[p] && mine[p] == 0 && reached[p] != 0) node_[p * spans_ + q] = nodes_++;
  }
}

// Allocates room for values to all pixels that have a node or are adjacent to one that has.
void SeamExpansion::find_slots() {
  slot_.assign(pixels(), -1);
  for (std::size_t p = 0; p < pixels(); ++p) {
    const auto nodes = std::span(node_).subspan(p * spans_, spans_);
    if (std::ranges::none_of(nodes, [](std::int32_t node) { return node >= 0; })) continue;
    for (const std::size_t near : {p, p - 1, p + 1, p - width(), p + width()})
      if (near < pixels() && slot_[near] < 0) slot_[near] = slots_++;
  }
}

void SeamExpansion::load() {
  old_.resize(static_cast<std::size_t>(slots_) * course_);
  new_.resize(old_.size());
  for (std::size_t p = 0; p < pixels(); ++p) {
    if (slot_[p] < 0) continue;
    const cv::Point at = pixel(p);
    const std::int32_t* shown = shown_.data() + p * spans_;
    for (std::size_t q = 0; q < spans_;) {
      const std::size_t first = q;
      while (q < spans_ && shown[q] == shown[first]) ++q;
      values_.copy(courses_.source_of(shown[first], at), begins_[first], end(q - 1),
                   old_.data() + value_index(p, begins_[first]));
    }
    const SourcePixel from = courses_.source_of(block_, at);
    if (values_.may_show(from)) values_.copy(from, 0, values_.frames(), new_.data() + value_index(p, 0));
  }
}

std::int32_t SeamExpansion::cost(const CourseValue* a, const CourseValue* b, std::size_t n) const {
  const std::int64_t sum = squared_step(a, b, n) + kSmooth * static_cast<std::int64_t>(n);
  return static_cast<std::int32_t>(std::min(sum / unit_, kMostCost));
}

void SeamExpansion::add_neighbours(core::MinimumCut& cut, std::size_t p, std::size_t r) const {
  if (slot_[p] < 0 || slot_[r] < 0) return;
  for (std::size_t q = 0; q < spans_; ++q) {
    const std::int32_t s = node_[p * spans_ + q], t = node_[r * spans_ + q];
    if (s < 0 && t < 0) continue;
    const std::int32_t a = shown_[p * spans_ + q], b = shown_[r * spans_ + q];
    const std::size_t from = value_index(p, begins_[q]), to = value_index(r, begins_[q]);
    const std::size_t n = static_cast<std::size_t>(end(q) - begins_[q]) * values_.channels();
    const auto step = [&](const std::vector<CourseValue>& one, const std::vector<CourseValue>& other) {
      return cost(one.data() + from, other.data() + to, n);
    };
    add_pair(cut, s, t,
             {a == b ? 0 : step(old_, old_), a == block_ || t < 0 ? 0 : step(old_, new_),
              b == block_ || s < 0 ? 0 : step(new_, old_)});
  }
}

// Adds pairs in time: between the last frame of a span and the first of the next.
void SeamExpansion::add_moments(core::MinimumCut& cut, std::size_t p) const {
  if (slot_[p] < 0) return;
  for (std::size_t q = 0; q + 1 < spans_; ++q) {
    const std::int32_t s = node_[p * spans_ + q], t = node_[p * spans_ + q + 1];
    if (s < 0 && t < 0) continue;
    const std::int32_t a = shown_[p * spans_ + q], b = shown_[p * spans_ + q + 1];
    const std::size_t to = value_index(p, begins_[q + 1]), from = to - values_.channels();
    const auto step = [&](const std::vector<CourseValue>& one, const std::vector<CourseValue>& other) {
      return cost(one.data() + from, other.data() + to, values_.channels());
    };
    add_pair(cut, s, t,
             {a == b ? 0 : step(old_, old_), a == block_ || t < 0 ? 0 : step(old_, new_),
              b == block_ || s < 0 ? 0 : step(new_, old_)});
  }
}

void SeamExpansion::solve() {
  load();
  core::MinimumCut cut(static_cast<std::size_t>(nodes_));
  for (std::size_t p = 0; p < pixels(); ++p) {
    if ((p + 1) % width() != 0) add_neighbours(cut, p, p + 1);
    if (p + width() < pixels()) add_neighbours(cut, p, p + width());
    add_moments(cut, p);
  }
  cut.solve();
  for (std::size_t i = 0; i < node_.size(); ++i)
    if (node_[i] >= 0 && cut.is_second(static_cast<std::size_t>(node_[i]))) shown_[i] = block_;
}

void SeamExpansion::write(BlockCourses& courses) const {
  for (std::size_t p = 0; p < pixels(); ++p) {
    const auto nodes = std::span(node_).subspan(p * spans_, spans_);
    if (std::ranges::any_of(nodes, [](std::int32_t node) { return node >= 0; }))
      courses.write(pixel(p), begins_, std::span(shown_).subspan(p * spans_, spans_));
  }
}

}  // namespace emberfold::dytex::detail
