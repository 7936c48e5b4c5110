// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace emberfold::sketch {

/// Samples of a section, half a pixel apart about its middle; a multiple of eight, in single precision, for
/// vectors.
inline constexpr std::size_t kMostSamples = 88;
inline constexpr double kSampleStep = 0.5;  ///< px
using Samples = std::array<float, kMostSamples>;

/// Holds the levels along a section across a curve.
struct Section {
  std::size_t count = 0;  ///< ≤ kMostSamples
  Samples level{};
  [[nodiscard]] double place(std::size_t i) const {
    return kSampleStep * (static_cast<double>(i) - 0.5 * static_cast<double>(count - 1));
  }
};

/// Holds a blurred bar.
/// It is `left`, then `middle` over `width` px about `offset`, then `right`, blurred by a Gaussian of SD
/// `blur`. Width 0 is a step at `offset`, whose middle does not count.
struct Profile {
  double offset = 0, width = 0, blur = 1;
  double left = 0, middle = 0, right = 0;
  double residual = 0;  ///< sum of squares
};

/// Holds the bounds of a fit, px.
struct ProfileBounds {
  double offset = 0;
  double least_width = 0, most_width = 0, least_blur = 0.3, most_blur = 0;
};

/// Fits the levels of a profile of this offset, width and blur; least squares in closed form.
Profile fit_levels(const Section& section, Profile shape);

/// Refines a profile near `start` within the bounds by least squares.
/// Levenberg-Marquardt over offset, width, blur and the levels, at most `steps` of them, each some 100
/// operations a sample in vectors. `prior`: weight, in squared levels, of the squared difference of log(blur)
/// from log(usual_blur), since in noise a narrow bar's width and blur are hardly distinguishable.
Profile refine_profile(const Section& section, Profile start, const ProfileBounds& bounds, int steps,
                       double prior, double usual_blur);

}  // namespace emberfold::sketch
