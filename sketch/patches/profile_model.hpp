// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace emberfold::sketch {

/// A section's samples, half a pixel apart about its middle; single precision and a multiple of eight of
/// them, for vectors.
inline constexpr std::size_t kMostSamples = 88;
inline constexpr double kSampleStep = 0.5;  ///< px
using Samples = std::array<float, kMostSamples>;

struct Section {
  std::size_t count = 0;  ///< ≤ kMostSamples
  Samples level{};
  [[nodiscard]] double place(std::size_t i) const {
    return kSampleStep * (static_cast<double>(i) - 0.5 * static_cast<double>(count - 1));
  }
};

/// A blurred bar: `left`, then `middle` over `width` px about `offset`, then `right`, blurred by a Gaussian
/// of SD `blur`; width 0 is a step at `offset`, whose middle counts for nothing.
struct Profile {
  double offset = 0, width = 0, blur = 1;
  double left = 0, middle = 0, right = 0;
  double residual = 0;  ///< sum of squares
};

/// How far a fit may move: px.
struct ProfileBounds {
  double offset = 0;
  double least_width = 0, most_width = 0, least_blur = 0.3, most_blur = 0;
};

/// Levels that suit the section best for this offset, width and blur; least squares in closed form.
Profile fit_levels(const Section& section, Profile shape);

/// The least-squares profile near `start` within the bounds: Levenberg-Marquardt over offset, width, blur and
/// the levels, at most `steps` of them, each some 100 operations a sample in vectors. `prior`: weight, in
/// squared levels, of the squared difference of log(blur) from log(usual_blur): a narrow bar's width and blur
/// show only together in noise.
Profile refine_profile(const Section& section, Profile start, const ProfileBounds& bounds, int steps,
                       double prior, double usual_blur);

}  // namespace emberfold::sketch
