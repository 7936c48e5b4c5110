// SPDX-License-Identifier: Apache-2.0
#include "dytex/distances/window_spectra.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/text/size_text.hpp"
#include "dytex/distances/window_bands.hpp"
#include "dytex/measures/check_frames.hpp"

namespace emberfold::dytex {

namespace {

constexpr std::size_t kWindowsAtOnce = 32;

std::size_t count_blocks(std::size_t windows) {
  return (windows + kWindowsAtOnce - 1) / kWindowsAtOnce;
}

// Adds the energies of one window: its coefficients are 2K × frames.
void add_energies(const Eigen::MatrixXf& coefficients, Eigen::Ref<Eigen::VectorXd> energies) {
  const auto& made = detail::window_transforms();
  const Eigen::Index waves = coefficients.rows() / 2;
  const Eigen::MatrixXf by_cosine = coefficients * made.time_cosine, by_sine = coefficients * made.time_sine;
  const auto real_cosine = by_cosine.topRows(waves).array(),
             imaginary_cosine = by_cosine.bottomRows(waves).array(),
             real_sine = by_sine.topRows(waves).array(), imaginary_sine = by_sine.bottomRows(waves).array();
  const Eigen::ArrayXXf onward =
      (real_cosine - imaginary_sine).square() + (real_sine + imaginary_cosine).square();
  const Eigen::ArrayXXf back =
      (real_cosine + imaginary_sine).square() + (imaginary_cosine - real_sine).square();
  for (Eigen::Index f = 0; f < onward.cols(); ++f) {
    const int band = detail::time_band(static_cast<int>(f) + 1) * detail::kPatterns;
    for (Eigen::Index k = 0; k < waves; ++k) {
      const auto wave = static_cast<std::size_t>(k);
      energies[band + made.pattern[wave]] += static_cast<double>(onward(k, f));
      energies[band + made.turned[wave]] += static_cast<double>(back(k, f));
    }
  }
}

}  // namespace

WindowEnergies::WindowEnergies(cv::Size size) : size_(size) {
  if (size.width < 1 || size.height < 1)
    throw core::InputError("window spectrum: the size is " + core::size_text(size) +
                           "; allowed is at least 1x1");
  const int step = detail::window_step(size.width, size.height);
  for (const int y : detail::window_starts(size.height, step))
    for (const int x : detail::window_starts(size.width, step)) windows_.emplace_back(x, y);
  energies_ = Eigen::MatrixXd::Zero(detail::kWindowBands, static_cast<Eigen::Index>(windows_.size()));
}

void WindowEnergies::add(const cv::Mat& luma) {
  detail::check_luma(luma, "window spectrum");
  if (luma.size() != size_)
    throw core::InputError("window spectrum: a frame is " + core::size_text(luma.size()) +
                           ", those before it " + core::size_text(size_));
  const auto& space = detail::window_transforms().space;
  Eigen::MatrixXf coefficients(space.rows(), static_cast<Eigen::Index>(windows_.size()));
  core::parallel_for(count_blocks(windows_.size()), {}, [&](std::size_t b) {
    const std::size_t first = b * kWindowsAtOnce, count = std::min(kWindowsAtOnce, windows_.size() - first);
    const auto columns = static_cast<Eigen::Index>(count);
    Eigen::MatrixXf levels(space.cols(), columns);
    for (std::size_t i = 0; i < count; ++i)
      for (int y = 0; y < detail::kWindow; ++y) {
        const cv::Point corner = windows_[first + i];
        levels.col(static_cast<Eigen::Index>(i)).segment(y * detail::kWindow, detail::kWindow) =
            Eigen::Map<const Eigen::VectorXf>(luma.ptr<float>(corner.y + y) + corner.x, detail::kWindow);
      }
    coefficients.middleCols(static_cast<Eigen::Index>(first), columns).noalias() = space * levels;
  });
  frames_.push_back(std::move(coefficients));
  if (frames_.size() < static_cast<std::size_t>(detail::kSegment)) return;
  close_segment();
  frames_.erase(frames_.begin(), frames_.begin() + detail::kSegment / 2);
}

void WindowEnergies::close_segment() {
  core::parallel_for(count_blocks(windows_.size()), {}, [&](std::size_t b) {
    const std::size_t last = std::min(windows_.size(), (b + 1) * kWindowsAtOnce);
    for (std::size_t i = b * kWindowsAtOnce; i < last; ++i) {
      const auto window = static_cast<Eigen::Index>(i);
      Eigen::MatrixXf coefficients(frames_[0].rows(), detail::kSegment);
      for (int t = 0; t < detail::kSegment; ++t)
        coefficients.col(t) = frames_[static_cast<std::size_t>(t)].col(window);
      add_energies(coefficients, energies_.col(window));
    }
  });
  ++segments_;
}

WindowSpectrum WindowEnergies::spectrum() const {
  return detail::mean_shares(energies_, std::max(1, segments_) * detail::least_energy());
}

WindowSpectrum window_spectrum(core::FrameSource& source, const core::Context& context) {
  const auto& info = source.info();
  WindowEnergies energies({info.width, info.height});
  source.rewind();
  for (cv::Mat frame = source.next(); !frame.empty(); frame = source.next()) {
    context.check();
    energies.add(core::luma(frame, info));
  }
  return energies.spectrum();
}

double window_distance(const Eigen::Ref<const Eigen::VectorXd>& p,
                       const Eigen::Ref<const Eigen::VectorXd>& q) {
  if (p.size() != q.size() || p.size() == 0)
    throw core::InputError("window distance: descriptions of " + std::to_string(p.size()) + " and " +
                           std::to_string(q.size()) + " bands cannot be compared");
  return std::sqrt((p - q).squaredNorm() / static_cast<double>(p.size()));
}

}  // namespace emberfold::dytex
