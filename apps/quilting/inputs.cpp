// SPDX-License-Identifier: Apache-2.0
#include "apps/quilting/inputs.hpp"

#include <algorithm>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/builtin/open_clip.hpp"
#include "apps/cli/interrupt.hpp"
#include "core/io/image_files.hpp"
#include "core/io/mask_file.hpp"
#include "core/text/size_text.hpp"
#include "dytex/quilting/flatten.hpp"
#include "dytex/quilting/render.hpp"

namespace emberfold::apps {

namespace {

/// Forwards another source's frames.
class SameSource final : public core::FrameSource {
 public:
  explicit SameSource(core::FrameSource& source) : source_(source) {}
  [[nodiscard]] const core::ClipInfo& info() const override { return source_.info(); }
  cv::Mat next() override { return source_.next(); }
  void rewind() override { source_.rewind(); }

 private:
  core::FrameSource& source_;
};

}  // namespace

QuiltClips::QuiltClips(const QuiltRequest& request, const io::ReadOptions& read, Session& session)
    : request_(request) {
  for (const auto& name : request.clips) {
    opened_.push_back(open_held_clip(name, read, session));
    if (request.flatten > 0)
      shown_.push_back(std::make_unique<dytex::FlattenedSource>(*opened_.back(), request.flatten));
    else
      shown_.push_back(std::make_unique<SameSource>(*opened_.back()));
    const auto& first = shown_.front()->info();
    const auto& info = shown_.back()->info();
    if (info.channels != first.channels || info.depth != first.depth)
      throw core::InputError(name + " has other channels or another depth than " + request.clips.front() +
                             "; --grey reads both as grey");
  }
}

std::vector<core::FrameSource*> QuiltClips::sources() const {
  std::vector<core::FrameSource*> list;
  for (const auto& source : shown_) list.push_back(source.get());
  return list;
}

std::vector<cv::Size> QuiltClips::sizes() const {
  std::vector<cv::Size> list;
  for (const auto& source : shown_) list.emplace_back(source->info().width, source->info().height);
  return list;
}

void QuiltClips::load(const std::filesystem::path& folder, Session& session) {
  cache_.emplace(folder, static_cast<std::size_t>(request_.memory) * 1'000'000);
  int chunk = dytex::chunk_length(info());
  for (const auto& source : shown_) chunk = std::min(chunk, dytex::chunk_length(source->info()));
  for (std::size_t i = 0; i < shown_.size(); ++i) {
    loaded_.push_back(dytex::read_trajectories(*shown_[i], cache_->memory(), session.context, chunk));
    session.check_stop();
    if (loaded_.back().frames() != loaded_.front().frames())
      throw core::InputError(request_.clips[i] + " has " + std::to_string(loaded_.back().frames()) +
                             " frames, " + request_.clips.front() + " " +
                             std::to_string(loaded_.front().frames()) + "; --range reads the same of both");
  }
}

std::vector<const dytex::Trajectories*> QuiltClips::loaded() const {
  std::vector<const dytex::Trajectories*> list;
  for (const auto& one : loaded_) list.push_back(&one);
  return list;
}

namespace {

std::vector<cv::Mat> frames_of(const dytex::Trajectories& source, int first, int count) {
  dytex::QuiltMap whole{source.size(), {}};
  for (int y = 0; y < whole.size.height; ++y)
    for (int x = 0; x < whole.size.width; ++x) whole.pixels.push_back({0, x, y});
  const std::vector<const dytex::Trajectories*> sources{&source};
  return dytex::render_quilt(whole, sources, {}, first, count);
}

// Returns the luma, averaged over time and blurred by a few pixels, to compare with a guide.
cv::Mat mean_luma(const dytex::Trajectories& source) {
  cv::Mat sum = cv::Mat::zeros(source.size(), CV_32F);
  for (int t = 0; t < source.frames(); t += source.chunk_frames())
    for (const auto& frame : frames_of(source, t, std::min(source.chunk_frames(), source.frames() - t)))
      sum += core::luma(frame, source.info());
  sum /= source.frames();
  cv::GaussianBlur(sum, sum, {}, 2, 2);
  return sum;
}

// Gives the guide the distribution of the source's levels, by rank.
cv::Mat match_levels(const cv::Mat& guide, const std::vector<dytex::QuiltSource>& sources) {
  std::vector<float> levels;
  for (const auto& source : sources)
    levels.insert(levels.end(), source.guide.begin<float>(), source.guide.end<float>());
  std::ranges::sort(levels);
  cv::Mat result(guide.size(), CV_32F);
  std::vector<float> own(guide.begin<float>(), guide.end<float>());
  std::ranges::sort(own);
  for (int y = 0; y < guide.rows; ++y)
    for (int x = 0; x < guide.cols; ++x) {
      const auto [first, last] = std::equal_range(own.begin(), own.end(), guide.at<float>(y, x));
      const double rank =
          (static_cast<double>(first - own.begin()) + static_cast<double>(last - own.begin())) / 2 /
          static_cast<double>(own.size());
      const auto index = static_cast<std::size_t>(rank * static_cast<double>(levels.size() - 1));
      result.at<float>(y, x) = levels[index];
    }
  return result;
}

cv::Mat luma_image(const std::string& name) {
  const cv::Mat pixels = io::read_image(name).pixels;
  core::ClipInfo info;
  info.depth = pixels.depth();
  if (info.depth == CV_16U) info.white = 65535;
  return core::luma(pixels, info);
}

}  // namespace

cv::Mat frame_of(const dytex::Trajectories& source, int frame) {
  return frames_of(source, frame, 1).front();
}

std::vector<dytex::QuiltSource> quilt_sources(const QuiltClips& clips, const QuiltRequest& request,
                                              cv::Mat& guide) {
  std::vector<dytex::QuiltSource> sources;
  for (const auto* held : clips.loaded()) sources.push_back({held, {}, {}});
  for (std::size_t i = 0; i < request.masks.size(); ++i) {
    const cv::Mat mask = io::read_inside(request.masks[i]);
    const cv::Size size = sources[i].trajectories->size();
    if (mask.size() != size)
      throw core::InputError(request.masks[i] + " has " + core::size_text(mask.size()) + " pixels, " +
                             request.clips[i] + " " + core::size_text(size));
    sources[i].forbidden = mask;
  }
  if (request.guide.empty()) return sources;
  for (auto& source : sources) source.guide = mean_luma(*source.trajectories);
  guide = luma_image(request.guide);
  const cv::Size size = request.quilt.size;
  const bool shrinks = guide.cols > size.width && guide.rows > size.height;
  cv::resize(guide, guide, size, 0, 0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);
  guide = match_levels(guide, sources);
  return sources;
}

}  // namespace emberfold::apps
