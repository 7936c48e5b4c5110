// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/quilt_checks.hpp"

#include <string>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "core/text/size_text.hpp"
#include "dytex/quilting/correlation.hpp"

namespace emberfold::dytex::detail {

namespace {

void check_masks(std::span<const QuiltSource> sources, const QuiltOptions& options) {
  for (const auto& source : sources) {
    const cv::Size size = source.trajectories->size();
    if (size.width < options.block.width || size.height < options.block.height) continue;
    if (source.forbidden.empty()) return;
    cv::Mat sums;
    cv::integral(source.forbidden != 0, sums, CV_64F);
    if (cv::countNonZero(box_sums(sums, {{{}, options.block}}, options.block) < 0.5) > 0) return;
  }
  throw core::InputError("the mask leaves no place for a block of " + core::size_text(options.block) +
                         " pixels");
}

}  // namespace

void check_sources(std::span<const QuiltSource> sources, const QuiltOptions& options, const cv::Mat& guide) {
  if (sources.empty()) throw core::InputError("quilting needs a source");
  const Trajectories& first = *sources.front().trajectories;
  if (!guide.empty() && (guide.size() != options.size || guide.type() != CV_32F))
    throw core::InputError("the guide is " + core::size_text(guide.size()) + " pixels, the output " +
                           core::size_text(options.size));
  bool fits = false;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const Trajectories& one = *sources[i].trajectories;
    const std::string name = "source " + std::to_string(i);
    if (one.frames() != first.frames())
      throw core::InputError(name + " has " + std::to_string(one.frames()) + " frames, source 0 has " +
                             std::to_string(first.frames()));
    if (one.info().channels != first.info().channels || one.info().depth != first.info().depth)
      throw core::InputError(name + " has other channels or another depth than source 0");
    if (one.chunk_frames() != first.chunk_frames())
      throw core::InputError(name + " is kept in other chunks than source 0");
    for (const auto* picture : {&sources[i].forbidden, &sources[i].guide})
      if (!picture->empty() && picture->size() != one.size())
        throw core::InputError(name + " has " + core::size_text(one.size()) + " pixels, its " +
                               (picture == &sources[i].guide ? "guide " : "mask ") +
                               core::size_text(picture->size()));
    if (!guide.empty() && sources[i].guide.type() != CV_32F)
      throw core::InputError(name + " has nothing that the guide could be held against");
    fits = fits || (one.size().width >= options.block.width && one.size().height >= options.block.height);
  }
  if (!fits)
    throw core::InputError("QuiltOptions.block is " + core::size_text(options.block) +
                           "; the source has only " + core::size_text(first.size()) + " pixels");
  check_masks(sources, options);
}

}  // namespace emberfold::dytex::detail
