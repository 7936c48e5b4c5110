// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core/types.hpp>

#include "core/math/minimum_cut.hpp"
#include "dytex/quilting/block_courses.hpp"
#include "dytex/quilting/course_values.hpp"

/// Moves of seams in x, y and t. Inner header of quilting.
namespace emberfold::dytex::detail {

/// Spans of source frames in which a seam does not move: where each begins, ascending from 0.
using SpanBegins = std::vector<int>;

/// Part of the output within which a block may take pixels.
struct SeamWindow {
  cv::Rect place;  ///< inside of the output; on a torus it may reach beyond its borders by less than its size
  int band = 0;    ///< px from the pixels that the block shows already; 0: all of the window
};

/// The move of one block: of all ways in which it can take pixels, in some spans, from those around it, the
/// one that minimises the cost of seams (an expansion, Boykov, Veksler & Zabih 2001). The cost of a pair of
/// neighbours in x, y or t that show different blocks is the squared difference of their values, plus a
/// little for each, so that seams do not wander where nothing differs. Seams that the block covers cost no
/// more. Never worse than before.
class SeamExpansion {
 public:
  SeamExpansion(const BlockCourses& courses, const CourseValues& values, const SeamWindow& window,
                std::int32_t block, const SpanBegins& begins);

  /// Returns whether there are pixels to take.
  [[nodiscard]] bool is_needed() const { return nodes_ > 0; }
  /// Finds the best move.
  void solve();
  /// Writes the best move.
  void write(BlockCourses& courses) const;

 private:
  [[nodiscard]] cv::Point pixel(std::size_t p) const;
  [[nodiscard]] std::size_t pixels() const { return static_cast<std::size_t>(place_.area()); }
  [[nodiscard]] std::size_t width() const { return static_cast<std::size_t>(place_.width); }
  [[nodiscard]] int end(std::size_t span) const;
  [[nodiscard]] std::vector<bool> open_pixels() const;
  void find_nodes(int band);
  void find_slots();
  void load();
  [[nodiscard]] std::int32_t cost(const CourseValue* a, const CourseValue* b, std::size_t n) const;
  void add_neighbours(core::MinimumCut& cut, std::size_t p, std::size_t r) const;
  void add_moments(core::MinimumCut& cut, std::size_t p) const;
  [[nodiscard]] std::size_t value_index(std::size_t p, int frame) const {
    return static_cast<std::size_t>(slot_[p]) * course_ +
           static_cast<std::size_t>(frame) * values_.channels();
  }

  const BlockCourses& courses_;
  const CourseValues& values_;
  cv::Rect place_;
  std::int32_t block_;
  const SpanBegins& begins_;
  std::size_t spans_, course_;
  std::int64_t unit_ = 1;                   // squared steps of a unit of cost
  std::vector<std::int32_t> shown_, node_;  // by pixel and span: the block, and the node or −1
  std::vector<std::int32_t> slot_;          // by pixel: index of its values, or −1
  std::int32_t nodes_ = 0, slots_ = 0;
  std::vector<CourseValue> old_, new_;  // by slot: values shown, values of the block
};

}  // namespace emberfold::dytex::detail
