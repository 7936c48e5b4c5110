// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "dytex/quilting/quilt.hpp"

/// Courses of source pixels as whole numbers. Inner header of quilting.
namespace emberfold::dytex::detail {

/// A level of any depth in 1/16 of a level of 255, at most ±512 levels.
using CourseValue = std::int16_t;
constexpr int kValuesPerLevel = 16;

class CourseValues {
 public:
  /// The sources have to outlive it.
  explicit CourseValues(std::span<const QuiltSource> sources) : sources_(sources) {}

  [[nodiscard]] int frames() const { return sources_.front().trajectories->frames(); }
  [[nodiscard]] std::size_t channels() const {
    return static_cast<std::size_t>(sources_.front().trajectories->info().channels);
  }
  /// Returns whether a pixel is inside its source and may be copied.
  [[nodiscard]] bool may_show(const SourcePixel& at) const;
  /// Writes frames begin … end − 1 of a pixel to out[0 …], in a frame the channels.
  void copy(const SourcePixel& at, int begin, int end, CourseValue* out) const;

 private:
  std::span<const QuiltSource> sources_;
};

/// Returns Σ (a − b)² / 128 over n values, each term rounded down: twice the squared difference in levels.
std::int64_t squared_step(const CourseValue* a, const CourseValue* b, std::size_t n);

}  // namespace emberfold::dytex::detail
