// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "graph/motion_graph.hpp"

namespace emberfold::mcmc::detail {

/// Holds a point of a curve in one frame.
struct TrackSample {
  graph::Point position;           ///< px, on the curve through the patches
  graph::Point normal;             ///< unit; its sense is kept from frame to frame
  double normal_displacement = 0;  ///< px along the normals since the track began
  double contrast = 0;             ///< logarithm of its absolute value
  std::uint32_t vertex = 0;        ///< index of the nearest patch
};

/// Holds a point of a curve followed through time.
/// The sketch places patches anew along a curve in every frame, so the path of a patch jitters along the
/// curve. A track goes from frame to frame along the curve's normal, the only motion of a curve that an image
/// shows.
struct CurveTrack {
  int first = 0;  ///< frame
  std::vector<TrackSample> samples;
  [[nodiscard]] int last() const { return first + static_cast<int>(samples.size()) - 1; }
};

/// Follows all curves that links carry on, with about one track for each patch inside a curve.
/// Returns the tracks ordered by first frame, then vertex. O(vertices).
std::vector<CurveTrack> track_curves(const graph::MotionGraph& motion);

/// Visits so many frames in order, each with the indices of the tracks that go through it, ascending.
/// O(samples).
void visit_frames(const std::vector<CurveTrack>& tracks, std::size_t frames,
                  const std::function<void(std::size_t frame, std::span<const std::uint32_t> there)>& visit);

/// Lists for every frame the pairs of tracks that lie next to each other on a curve.
struct TrackNeighbours {
  struct Pair {
    std::uint32_t a = 0, b = 0;  ///< indices of tracks
    int sense = 1;               ///< −1 where their normals point to opposite sides
  };
  std::vector<std::vector<Pair>> frames;
};

/// Finds the nearest track ahead and behind of each track in every frame, up to 12 px away. O(samples).
TrackNeighbours find_track_neighbours(const graph::MotionGraph& motion,
                                      const std::vector<CurveTrack>& tracks);
/// Visits each frame's pairs of neighbours, in order, and keeps none.
void visit_track_neighbours(
    const graph::MotionGraph& motion, const std::vector<CurveTrack>& tracks,
    const std::function<void(std::size_t frame, const std::vector<TrackNeighbours::Pair>& pairs)>& visit);

/// Holds a value that a track assigns to a patch.
struct TrackValue {
  std::uint32_t vertex = 0;
  graph::Point value;
};

/// Interpolates tracks' values over the patches of a frame.
/// Each patch gets the mean of its tracks' values, smoothed along the curves; a patch without a track gets
/// its neighbours' mean, or 0. O(vertices).
std::vector<graph::Point> smooth_over_patches(const graph::AttributeGraph& graph,
                                              const std::vector<TrackValue>& track_values);

}  // namespace emberfold::mcmc::detail
