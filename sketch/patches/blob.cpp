// SPDX-License-Identifier: Apache-2.0
#include "sketch/patches/blob.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <opencv2/core.hpp>

#include "core/math/luma.hpp"
#include "sketch/patches/blob_shape.hpp"

namespace emberfold::sketch {

namespace {

constexpr std::size_t kTerms = 4;  // level, slopes along x and y, bump

using Row = std::array<double, kTerms>;

/// Solves (AᵀA + ε) x = Aᵀy by elimination with pivots; ε keeps undetermined terms at 0 where the frame cuts
/// the disc.
Row least_squares(const std::vector<Row>& rows, const std::vector<double>& values) {
  std::array<std::array<double, kTerms + 1>, kTerms> m{};
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t a = 0; a < kTerms; ++a) {
      for (std::size_t b = 0; b < kTerms; ++b) m[a][b] += rows[i][a] * rows[i][b];
      m[a][kTerms] += rows[i][a] * values[i];
    }
  for (std::size_t a = 0; a < kTerms; ++a) m[a][a] += 1e-6;
  for (std::size_t a = 0; a < kTerms; ++a) {
    std::size_t pivot = a;
    for (std::size_t b = a + 1; b < kTerms; ++b)
      if (std::abs(m[b][a]) > std::abs(m[pivot][a])) pivot = b;
    std::swap(m[a], m[pivot]);
    for (std::size_t b = 0; b < kTerms; ++b) {
      if (b == a) continue;
      const double share = m[b][a] / m[a][a];
      for (std::size_t c = a; c <= kTerms; ++c) m[b][c] -= share * m[a][c];
    }
  }
  Row x{};
  for (std::size_t a = 0; a < kTerms; ++a) x[a] = m[a][kTerms] / m[a][a];
  return x;
}

}  // namespace

graph::Patch fit_blob(const cv::Mat& levels, cv::Point centre, double reach) {
  graph::Patch blob;
  blob.type = graph::PatchType::blob;
  blob.position = {static_cast<double>(centre.x), static_cast<double>(centre.y)};
  blob.width = 2 * reach / 3;
  blob.blur = reach / 3;
  const BlobShape shape(blob);
  const int channels = levels.channels(), whole = static_cast<int>(std::ceil(reach));
  std::vector<Row> rows;
  std::array<std::vector<double>, 3> values;
  for (int y = std::max(centre.y - whole, 0); y <= std::min(centre.y + whole, levels.rows - 1); ++y)
    for (int x = std::max(centre.x - whole, 0); x <= std::min(centre.x + whole, levels.cols - 1); ++x) {
      const double dx = x - centre.x, dy = y - centre.y;
      if (!shape.holds(dx, dy)) continue;
      rows.push_back({1, dx, dy, shape.at(dx, dy).middle});
      for (int c = 0; c < channels; ++c)
        values[static_cast<std::size_t>(c)].push_back(double{levels.ptr<float>(y)[x * channels + c]});
    }
  std::array<Row, 3> fitted{};
  for (std::size_t c = 0; c < 3; ++c)
    fitted[c] = c < static_cast<std::size_t>(channels) ? least_squares(rows, values[c]) : fitted[0];
  // The ramp rises the way luma does; what a channel rises across that way is left out.
  const auto luma = [&](std::size_t term) {
    return channels == 1 ? fitted[0][term] : core::luma(fitted[0][term], fitted[1][term], fitted[2][term]);
  };
  const double steepness = std::hypot(luma(1), luma(2));
  const double nx = steepness > 0 ? luma(1) / steepness : 0, ny = steepness > 0 ? luma(2) / steepness : 1;
  blob.theta = std::atan2(-nx, ny);
  for (std::size_t c = 0; c < 3; ++c) {
    const double rise = (fitted[c][1] * nx + fitted[c][2] * ny) * shape.reach();
    blob.left[c] = static_cast<float>(fitted[c][0] - rise);
    blob.right[c] = static_cast<float>(fitted[c][0] + rise);
    blob.middle[c] = static_cast<float>(fitted[c][0] + fitted[c][3]);
  }
  blob.contrast = luma(3);
  return blob;
}

}  // namespace emberfold::sketch
