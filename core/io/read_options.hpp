// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "core/option_field.hpp"

namespace emberfold::io {

/// Selects which values of a clip of 16 bits or floats are black and white.
struct Levels {
  enum class Kind {
    used,    ///< black is 0, white the largest number of the bits that the brightest value needs; other
             ///< ranges where that would hide the picture (find_levels)
    full,    ///< all that the format holds: 0…65535; of floats from the smallest to the largest value
    given,   ///< from `low` to `high`, for 8 bits too; values outside become black or white
    stored,  ///< as `used`, but no value is ever moved or cut: masks, probabilities
  };
  Kind kind = Kind::used;
  double low = 0, high = 0;  ///< low < high, where given
};

/// A rectangle of pixels of the clip as it is stored.
struct Region {
  int x = 0, y = 0, width = 0, height = 0;  ///< px; x, y ≥ 0, width, height ≥ 1
};

/// Selects which motion of the whole picture is removed.
enum class Stabilize { none, translation, similarity };

/// Options for which part of a clip is read, and how. Applied in the order slice and channel, levels, range,
/// every, stabilize, region, grey, scale.
struct ReadOptions {
  std::int64_t first = 0;            ///< first frame as stored, from 0
  std::optional<std::int64_t> last;  ///< one past the last frame, > first; none: to the end
  double scale = 1;                  ///< sizes are rounded
  bool grey = false;                 ///< luma (Rec. 601) only
  std::uint64_t seed = 1;            ///< of built-in clips
  std::optional<int> channel;        ///< ≥ 0: of a stack, or red, green, blue of a picture in colour
  std::optional<int> slice;          ///< ≥ 0: of a stack in depth
  bool brightest_slice = false;      ///< the brightest value of all slices instead
  Levels levels;
  std::optional<double> fps;         ///< acquisition rate, frames a second, (0, 1e6]
  std::optional<double> pixel_size;  ///< side of a stored pixel, µm, (0, 1e9]
  int every = 1;  ///< 1…1000000: takes the first frame of the range and every n-th from there
  std::optional<Region> region;
  std::string mask;  ///< image or clip, as large as the clip as stored: structure counts where it is not 0
  Stabilize stabilize = Stabilize::none;
  bool counts_from_part = false;  ///< positions and times: from `first` and `region`, not from the source

  /// Returns the description of the plain numeric field, for checks and help.
  static auto fields() {
    using core::above;
    return std::to_array<core::OptionField<ReadOptions>>({
        {"scale", &ReadOptions::scale, "FACTOR", above(0, 16),
         "Resize the frames by this factor; at least 1 px remains"},
    });
  }
  /// Throws core::InputError naming field, value and range.
  void validate() const;
  /// Returns the options for another clip aligned with this one, pixel by pixel and frame by frame: a mask,
  /// or what was found in it. Its values are read unchanged.
  [[nodiscard]] ReadOptions beside() const;
};

/// Parses a range of frames: "a:b" (from a up to, not including, b), "a:" or ":b". Throws core::InputError
/// for any other text and for an empty range.
std::pair<std::int64_t, std::optional<std::int64_t>> parse_range(const std::string& text);

/// Parses "auto", "full" or "LOW:HIGH". Throws core::InputError for any other text.
Levels parse_levels(const std::string& text);
/// Parses "x,y,width,height". Throws core::InputError for any other text.
Region parse_region(const std::string& text);
/// Parses a length with its unit, "0.065um" (nm, um or µm, mm, cm, m); returns µm. Throws core::InputError.
double parse_length(const std::string& text);
/// Parses "none", "translation" or "similarity". Throws core::InputError for any other text.
Stabilize parse_stabilize(const std::string& text);
/// Returns the text that parse_stabilize reads.
std::string name(Stabilize stabilize);

}  // namespace emberfold::io
