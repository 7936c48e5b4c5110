// SPDX-License-Identifier: Apache-2.0
#include "pipeline/edit_model.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "core/error.hpp"

namespace emberfold::pipeline {

EditedClipModel edit_model(ClipModel model, const mcmc::MotionEdit& edit, std::uint64_t seed,
                           const core::Context& context) {
  edit.validate();
  EditedClipModel edited{std::move(model), {}};
  if (edit == mcmc::MotionEdit{}) return edited;
  auto& changed = edited.model;
  auto motion = mcmc::edit_motion(changed.motion, edit, seed, context);
  changed.motion = std::move(motion.model);
  std::ranges::move(motion.notes, std::back_inserter(edited.notes));
  changed.footage.reset();
  return edited;
}

mcmc::CellMap birth_map(const cv::Mat& picture, const mcmc::MotionModel& model) {
  if (picture.empty() || picture.channels() != 1)
    throw core::InputError("birth_map is no picture of one channel");
  cv::Mat levels, fitted;
  picture.convertTo(levels, CV_32F);
  cv::resize(levels, fitted, {model.width, model.height}, 0, 0,
             levels.cols > model.width ? cv::INTER_AREA : cv::INTER_LINEAR);
  mcmc::CellMap map = model.rates.birth;
  std::vector<double> counts(map.values.size());
  std::ranges::fill(map.values, 0.0);
  for (int y = 0; y < model.height; ++y)
    for (int x = 0; x < model.width; ++x) {
      const auto cell = map.index({double(x), double(y)});
      map.values[cell] += double{fitted.at<float>(y, x)};
      ++counts[cell];
    }
  double sum = 0;
  for (std::size_t c = 0; c < counts.size(); ++c) sum += map.values[c] /= std::max(1.0, counts[c]);
  if (!(sum > 0)) throw core::InputError("birth_map is black: nothing would be born");
  return map;
}

}  // namespace emberfold::pipeline
