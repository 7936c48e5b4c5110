// SPDX-License-Identifier: Apache-2.0
#include "pipeline/comparison/clip_profile.hpp"

#include "pipeline/comparison/clip_strokes.hpp"

namespace emberfold::pipeline {

ClipProfile clip_profile(const ClipMeasures& pixels, const OptionalStrokes& strokes) {
  return {pixels.figures(), pixels.curves(), strokes};
}

ClipDistances clip_distances(const ClipMeasures& pixels, const OptionalStrokes& strokes,
                             const ClipMeasures& reference, const OptionalStrokes& reference_strokes) {
  ClipDistances out{pixel_distances(pixels, reference), {}, {}};
  if (strokes && reference_strokes) out.strokes = stroke_distances(*strokes, *reference_strokes);
  return out;
}

ClipDistances noise_floor(const SourceMeasures& source, const mcmc::StrokeSeries* strokes) {
  ClipDistances out{pixel_distances(source.first, source.second), {}, {}};
  if (strokes == nullptr) return out;
  const int half = source.frames / 2;
  out.strokes = stroke_distances(mcmc::stroke_statistics(select_frames(*strokes, 0, half)),
                                 mcmc::stroke_statistics(select_frames(*strokes, half, source.frames)));
  return out;
}

std::vector<cv::Mat> next_levels(core::FrameSource& source, int most, const core::Context& context) {
  std::vector<cv::Mat> levels;
  while (std::ssize(levels) < most) {
    const cv::Mat frame = source.next();
    context.check();
    if (frame.empty()) break;
    levels.push_back(core::to_levels(frame, source.info()));
  }
  return levels;
}

}  // namespace emberfold::pipeline
