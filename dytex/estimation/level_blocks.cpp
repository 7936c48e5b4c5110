// SPDX-License-Identifier: Apache-2.0
#include "dytex/estimation/level_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include <opencv2/core/hal/interface.h>

#include "core/error.hpp"
#include "core/parallel.hpp"

namespace emberfold::dytex::detail {

namespace {

template <class Value>
void read_column(const void* frame, std::size_t begin, double to_levels,
                 const Eigen::Ref<const Eigen::VectorXd>& mean, Eigen::Ref<Eigen::VectorXd> to) {
  const auto* from = static_cast<const Value*>(frame) + begin;
  to = Eigen::Map<const Eigen::Vector<Value, Eigen::Dynamic>>(from, to.size()).template cast<double>() *
           to_levels -
       mean;
}

/// Information and constants of the rows that `taken` picks, added up in order.
struct RowSums {
  Eigen::MatrixXd information;  // lower half
  double constants = 0;

  void add(const WeightedRows& rows, const std::vector<Eigen::Index>& taken) {
    Eigen::MatrixXd scaled(static_cast<Eigen::Index>(taken.size()), rows.C.cols());
    for (std::size_t i = 0; i < taken.size(); ++i) {
      scaled.row(static_cast<Eigen::Index>(i)) = std::sqrt(rows.inverse[taken[i]]) * rows.C.row(taken[i]);
      constants += std::log(2 * std::numbers::pi / rows.inverse[taken[i]]);
    }
    information.selfadjointView<Eigen::Lower>().rankUpdate(scaled.transpose());
  }
};

/// Lists one frame for each different way of hiding some of the pixels.
std::vector<std::size_t> partly_hidden_frames(const Missing& missing) {
  std::vector<std::size_t> result;
  for (std::size_t t = 0; t < missing.frames(); ++t) {
    if (missing.all_seen(t) || missing.all_hidden(t)) continue;
    if (t == 0 || missing.groups()[t] != missing.groups()[t - 1]) result.push_back(t);
  }
  return result;
}

/// Returns whether fewer pixels of the frame are hidden than seen, so that they are summed and subtracted
/// from the whole.
bool sums_hidden(const Missing& missing, std::size_t frame) {
  return 2 * missing.count(frame) <= missing.pixels();
}

/// Adds a block's rows that are hidden in the frame, or seen where those are fewer.
void add_pixels_of(const Missing& missing, std::size_t frame, Eigen::Index row, const LevelScale& scale,
                   const WeightedRows& rows, RowSums& sums) {
  const bool hidden = sums_hidden(missing, frame);
  std::vector<Eigen::Index> taken;
  for (Eigen::Index i = 0; i < rows.C.rows(); ++i)
    if (missing.hidden(static_cast<std::size_t>(row + i) / scale.channels, frame) == hidden)
      taken.push_back(i);
  if (!taken.empty()) sums.add(rows, taken);
}

}  // namespace

Eigen::MatrixXd level_block(const FrameValues& values, std::size_t first, std::size_t begin,
                            Eigen::Index rows, std::size_t first_frame, const LevelScale& scale,
                            const Missing& missing, const Eigen::Ref<const Eigen::VectorXd>& mean) {
  const auto frames = static_cast<Eigen::Index>(values.frames.size());
  Eigen::MatrixXd block(rows, frames);
  for (Eigen::Index t = 0; t < frames; ++t) {
    const void* frame = values.frames[static_cast<std::size_t>(t)];
    if (values.depth == CV_8U) {
      read_column<std::uint8_t>(frame, begin, scale.to_levels, mean, block.col(t));
    } else if (values.depth == CV_16U) {
      read_column<std::uint16_t>(frame, begin, scale.to_levels, mean, block.col(t));
    } else {
      read_column<float>(frame, begin, scale.to_levels, mean, block.col(t));
    }
    const std::size_t index = first_frame + static_cast<std::size_t>(t);
    if (!missing.all_seen(index))
      for (Eigen::Index i = 0; i < rows; ++i)
        if (missing.hidden((first + begin + static_cast<std::size_t>(i)) / scale.channels, index))
          block(i, t) = 0;
    if (values.depth == CV_32F && !block.col(t).allFinite())
      throw core::InputError("frame " + std::to_string(index) + " has a value that is not finite");
  }
  return block;
}

void for_sum_blocks(Eigen::Index m, const core::Context& context,
                    const std::function<void(std::size_t, Eigen::Index, Eigen::Index)>& body) {
  const auto step = static_cast<Eigen::Index>(kBlock), blocks = (m + step - 1) / step;
  const auto slabs = static_cast<Eigen::Index>(kSumSlabs);
  core::parallel_for(kSumSlabs, context, [&](std::size_t slab) {
    const auto s = static_cast<Eigen::Index>(slab);
    for (Eigen::Index b = blocks * s / slabs; b < blocks * (s + 1) / slabs; ++b) {
      context.check();
      body(slab, b * step, std::min(step, m - b * step));
    }
  });
}

void add_information(Eigen::Index m, Eigen::Index n, std::size_t frames, const LevelScale& scale,
                     const Missing& missing, const RowsOf& rows_of, Observations& result,
                     const core::Context& context) {
  const RowSums none{Eigen::MatrixXd::Zero(n, n)};
  std::vector<RowSums> slabs(kSumSlabs, none);
  for_sum_blocks(m, context, [&](std::size_t slab, Eigen::Index row, Eigen::Index rows) {
    std::vector<Eigen::Index> all(static_cast<std::size_t>(rows));
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Eigen::Index>(i);
    slabs[slab].add(rows_of(row, rows), all);
  });
  for (std::size_t s = 1; s < kSumSlabs; ++s) {
    slabs[0].information += slabs[s].information;
    slabs[0].constants += slabs[s].constants;
  }

  const std::vector<std::size_t> partly = partly_hidden_frames(missing);
  std::vector<RowSums> sums(partly.size(), none);
  core::parallel_for(kSumSlabs, context, [&](std::size_t chunk) {
    const std::size_t begin = partly.size() * chunk / kSumSlabs,
                      end = partly.size() * (chunk + 1) / kSumSlabs;
    const auto step = static_cast<Eigen::Index>(kBlock);
    for (Eigen::Index row = 0; begin < end && row < m; row += step) {
      context.check();
      const WeightedRows rows = rows_of(row, std::min(step, m - row));
      for (std::size_t g = begin; g < end; ++g) add_pixels_of(missing, partly[g], row, scale, rows, sums[g]);
    }
  });
  for (std::size_t g = 0; g < partly.size(); ++g) {
    if (!sums_hidden(missing, partly[g])) continue;
    sums[g].information = slabs[0].information - sums[g].information;
    sums[g].constants = slabs[0].constants - sums[g].constants;
  }

  result.information.clear();
  result.which.assign(frames, 0);
  result.constants = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(frames), slabs[0].constants);
  const auto keep = [&](const RowSums& from) {
    result.information.emplace_back(from.information.selfadjointView<Eigen::Lower>());
  };
  keep(slabs[0]);
  std::size_t group = 0;
  for (std::size_t t = 0; t < missing.frames(); ++t) {
    const auto at = static_cast<Eigen::Index>(t);
    if (missing.all_seen(t)) continue;
    if (missing.all_hidden(t)) {
      result.which[t] = -1;
      result.constants[at] = 0;
      continue;
    }
    if (group < partly.size() && partly[group] == t) keep(sums[group++]);
    result.which[t] = static_cast<int>(group);
    result.constants[at] = sums[group - 1].constants;
  }
}

}  // namespace emberfold::dytex::detail
