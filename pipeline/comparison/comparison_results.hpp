// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "mcmc/learning/clip_statistics.hpp"

// Results of a comparison, by clip and by model.
namespace emberfold::pipeline {

/// Holds the lengths of the measured curves; they must agree in clips that are compared.
struct MeasureScale {
  int segment = 4;  ///< frames in a segment of the spectrum in time
  int lags = 1;     ///< frames, the longest lag of the autocorrelation
  int rings = 1;    ///< rings of the spectrum in space
};

/// Holds the measures of a clip's pixels that are single numbers.
struct PixelFigures {
  double crease_sharpness = 0;  ///< 1/px, mean over frames
  double crease_gradient = 0;   ///< levels/px, mean over frames
  double si = 0, mean_si = 0;   ///< ITU-T P.910 SI: maximum over frames, as P.910 defines it, and mean
  double ti = 0, mean_ti = 0;   ///< ITU-T P.910 TI, likewise

  bool operator==(const PixelFigures&) const = default;
};

/// Holds the curves of a clip that its distances are taken between.
struct MeasureCurves {
  std::vector<double> temporal_db;  ///< power, dB, at k / segment cycles per frame, k = 1 … segment / 2
  std::vector<double> radial_db;  ///< power, dB, in ring i = 1 … rings, up to i / (2 rings) cycles per pixel
  std::vector<double> autocorrelation;  ///< at lags of 1 … `lags` frames

  bool operator==(const MeasureCurves&) const = default;
};

/// Holds the distances of a clip's pixels from those of a reference, each 0 for equal clips.
struct PixelDistances {
  double temporal_db = 0;       ///< dB, between the spectra in time
  double radial_db = 0;         ///< dB, between the spectra in space
  double autocorrelation = 0;   ///< RMS difference of the autocorrelations
  double patterns = 0;          ///< chi-square distance of the binary patterns (LBP-TOP), 0…1
  double flow_px = 0;           ///< px per frame, Wasserstein distance of the optical flows
  double crease_sharpness = 0;  ///< share of the reference's: 0.1 means 10 % more or less
  double si = 0;                ///< share of the reference's mean SI
  double ti = 0;                ///< share of the reference's mean TI

  bool operator==(const PixelDistances&) const = default;
};

/// Holds the distances of a clip's strokes from those of a reference.
struct StrokeDistances {
  /// RMS over the six classes of ln (rate / reference's rate), with half an event added to each count.
  double event_rates = 0;
  std::optional<double> lifetime, length;  ///< |ln (mean / reference's mean)|; none where either has none
  /// True where the clip's mean is in the 95 % interval of the reference's; of rates by graph::EventType.
  std::array<bool, 6> rate_inside{};
  bool lifetime_inside = false, length_inside = false;

  bool operator==(const StrokeDistances&) const = default;
};

/// Holds the visible differences of a drawn clip from its source, where the source moves.
struct VisibleFigures {
  /// Distance of the source's patches of 3 frames and 7×7 px to the nearest ones of the clip, divided by that
  /// to the nearest of the source's first half: above 1 the clip lacks something that the source shows.
  double complete = 0;
  /// Distance of the clip's patches to the nearest ones of the source, with the same divisor: above 1 the
  /// clip shows something that the source does not. With `complete`, the two terms of Simakov et al. 2008's
  /// similarity.
  double coherent = 0;
  double flow = 0;        ///< 95th percentile of the speed of optical flow, share of the source's
  double variance = 0;    ///< over time, share of the source's
  double difference = 0;  ///< 0…1, share of pixels within 2 levels of one source frame (CopiedShare)
  double copied =
      0;  ///< 0…1, share of pixels within 2 levels of those of one frame of the source (CopiedShare)

  /// Returns whether flow, variance and difference are all in 0.7…1.4.
  [[nodiscard]] bool moves_alike() const;

  /// Returns the visible distance of the clip from the source, ≥ 0: the root of the squared natural
  /// logarithms of flow, variance and difference, each at most ln 3, and of three times those of `complete`
  /// and `coherent` above 1.
  [[nodiscard]] double apart() const;

  bool operator==(const VisibleFigures&) const = default;
};

/// Holds the measures of one clip.
struct ClipProfile {
  PixelFigures pixels;
  MeasureCurves curves;
  std::optional<mcmc::StrokeStatistics> strokes;  ///< none where strokes were not sought
};

/// Holds the distances of a clip from a reference.
struct ClipDistances {
  PixelDistances pixels;
  std::optional<StrokeDistances> strokes;  ///< none where strokes were not sought
  std::optional<VisibleFigures> visible;   ///< none for the noise floor

  bool operator==(const ClipDistances&) const = default;
};

/// Holds the agreement of predicted or reconstructed frames with the true ones.
struct FrameQuality {
  double psnr = 0;  ///< dB, of the mean square error over all frames, pixels and channels; at most 100
  double ssim = 0;  ///< of luma, mean over frames

  bool operator==(const FrameQuality&) const = default;
};

/// Holds the quality of one method's predictions.
struct MethodPrediction {
  std::string key;                                   ///< a model's key, "frame_before" or "mean_image"
  std::vector<std::optional<FrameQuality>> by_step;  ///< none where the clip has no such frame
  std::vector<double> next_frame_psnr;               ///< dB, one step ahead, by start
  std::optional<FrameQuality> reconstruction;        ///< of a given frame
};

/// Holds the quality of predictions of frames from those before them.
struct PredictionMeasures {
  int first_frame = 0;     ///< the first predicted frame
  int starts = 0;          ///< frames that were predicted from
  std::vector<int> steps;  ///< frames ahead, ascending
  std::vector<MethodPrediction> methods;
};

}  // namespace emberfold::pipeline
