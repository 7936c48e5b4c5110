// SPDX-License-Identifier: Apache-2.0
#include "dytex/synthesis/draw_frames.hpp"

#include <algorithm>
#include <cstring>

namespace emberfold::dytex::detail {

namespace {

using Eigen::Index;

// 1.5 · 2²³: a float of this size has no fractional bits, so that adding it rounds; the value is then in the
// last byte.
constexpr float kRounder = 12582912.0F;

// Vectors of this number of lanes, and their unaligned loads and stores.
// Typedefs, since GCC ignores the attribute of an alias that depends on a template parameter.
template <int kLanes>
struct Lanes {
  typedef float Float __attribute__((vector_size(4 * kLanes)));
  typedef std::int32_t Int __attribute__((vector_size(4 * kLanes)));
  typedef std::int16_t Short __attribute__((vector_size(2 * kLanes)));
  typedef std::uint8_t Byte __attribute__((vector_size(kLanes)));
};

// Everything below is inlined into functions compiled for one kind of vectors, and nothing passes a vector by
// value, as the calling convention depends on that kind.
#define EMBERFOLD_INLINE [[gnu::always_inline]] inline

// Columns of C are so far apart that a walk across all of them misses every cache, and where their distance
// is a power of two they evict each other. So a few of them are read together, for a stretch of rows whose
// sums stay in the first cache.
constexpr Index kColumns = 8, kStretch = 512;

/// The sums of `kFrames` frames of kVectors · kLanes values, in registers.
template <int kLanes, int kVectors, int kFrames>
struct Tile {
  using Float = typename Lanes<kLanes>::Float;
  static constexpr Index kRows = kVectors * kLanes;
  Float sums[kFrames][kVectors];

  EMBERFOLD_INLINE static void load(const float* from, Float (&to)[kVectors]) {
#pragma GCC unroll 4
    for (int v = 0; v < kVectors; ++v) std::memcpy(&to[v], from + v * kLanes, sizeof to[v]);
  }

  EMBERFOLD_INLINE void start(const float* mean) {
#pragma GCC unroll 8
    for (int f = 0; f < kFrames; ++f) load(mean, sums[f]);
  }
  EMBERFOLD_INLINE void take_up(const float* from) {
#pragma GCC unroll 8
    for (int f = 0; f < kFrames; ++f) load(from + f * kRows, sums[f]);
  }
  EMBERFOLD_INLINE void put_down(float* to) const {
#pragma GCC unroll 8
    for (int f = 0; f < kFrames; ++f)
#pragma GCC unroll 4
      for (int v = 0; v < kVectors; ++v)
        std::memcpy(to + f * kRows + v * kLanes, &sums[f][v], sizeof sums[f][v]);
  }

  /// Adds columns from `values` on, `distance` apart, each times its states.
  EMBERFOLD_INLINE void add(const float* values, Index distance, const float* states, Index columns) {
    for (Index k = 0; k < columns; ++k, values += distance, states += kBatch) {
      Float column[kVectors];
      load(values, column);
#pragma GCC unroll 8
      for (int f = 0; f < kFrames; ++f)
#pragma GCC unroll 4
        for (int v = 0; v < kVectors; ++v) sums[f][v] = sums[f][v] + column[v] * states[f];
    }
  }

  EMBERFOLD_INLINE void store(int f, float* to) const {
    std::memcpy(to, sums[f], sizeof sums[f]);
  }

  EMBERFOLD_INLINE void store(int f, std::uint8_t* to) const {
    const Float none = {}, white = none + 255.0F;
#pragma GCC unroll 4
    for (int v = 0; v < kVectors; ++v) {
      Float level = sums[f][v];
      level = level > none ? level : none;
      level = level < white ? level : white;
      level += kRounder;
      typename Lanes<kLanes>::Int bits;
      std::memcpy(&bits, &level, sizeof bits);
      const auto bytes = __builtin_convertvector(__builtin_convertvector(bits, typename Lanes<kLanes>::Short),
                                                 typename Lanes<kLanes>::Byte);
      std::memcpy(to + v * kLanes, &bytes, kLanes);
    }
  }
};

EMBERFOLD_INLINE void put(float level, float& to) {
  to = level;
}
EMBERFOLD_INLINE void put(float level, std::uint8_t& to) {
  level = level > 0 ? level : 0;
  level = (level < 255.0F ? level : 255.0F) + kRounder;
  std::int32_t bits = 0;
  std::memcpy(&bits, &level, sizeof bits);
  to = static_cast<std::uint8_t>(bits);
}

/// A stretch of whole tiles: count is a multiple of their rows. frames[i] + offset gets the values.
template <class Rows, int kFrames, class Value>
EMBERFOLD_INLINE void draw_stretch(const Batch& batch, Index first, Index count,
                                   const std::array<Value*, kBatch>& frames, Index offset) {
  alignas(64) float sums[kStretch * kBatch];
  Index k = 0;
  do {
    const Index columns = std::min(kColumns, batch.components - k);
    const bool last = k + columns >= batch.components;
    const float* values =
        columns > 0 ? batch.C + k * batch.values + first : nullptr;  // no components: no matrix
    for (Index row = 0; row < count; row += Rows::kRows)
      for (Index frame = 0; frame < kBatch; frame += kFrames) {
        Rows tile;  // NOLINT(cppcoreguidelines-pro-type-member-init): the next lines fill it
        float* const kept = sums + row * kBatch + frame * Rows::kRows;
        if (k == 0)
          tile.start(batch.mean + first + row);
        else
          tile.take_up(kept);
        if (columns > 0) tile.add(values + row, batch.values, batch.states + k * kBatch + frame, columns);
        if (!last)
          tile.put_down(kept);
        else
#pragma GCC unroll 8
          for (int f = 0; f < kFrames; ++f)
            tile.store(f, frames[static_cast<std::size_t>(frame + f)] + offset + row);
      }
    k += columns;
  } while (k < batch.components);
}

/// frames[i] + offset gets the values.
template <int kLanes, int kVectors, int kFrames, class Value>
EMBERFOLD_INLINE void draw(const Batch& batch, Index first, Index count,
                           const std::array<Value*, kBatch>& frames, Index offset) {
  using Rows = Tile<kLanes, kVectors, kFrames>;
  const Index whole = count - count % Rows::kRows;
  for (Index done = 0; done < whole; done += kStretch)
    draw_stretch<Rows, kFrames>(batch, first + done, std::min(kStretch, whole - done), frames, offset + done);
  for (Index row = whole; row < count; ++row)
    for (Index frame = 0; frame < kBatch; ++frame) {
      float level = batch.mean[first + row];
      for (Index k = 0; k < batch.components; ++k)
        level = level + batch.C[k * batch.values + first + row] * batch.states[k * kBatch + frame];
      put(level, frames[static_cast<std::size_t>(frame)][offset + row]);
    }
}

template <class Value>
using Frames = std::array<Value*, kBatch>;

template <class Value>
void draw_plain(const Batch& batch, Index first, Index count, const Frames<Value>& frames, Index offset) {
  draw<4, 2, 4>(batch, first, count, frames, offset);
}

#if defined(__x86_64__)
template <class Value>
__attribute__((target("avx2"))) void draw_avx2(const Batch& batch, Index first, Index count,
                                               const Frames<Value>& frames, Index offset) {
  draw<8, 2, 4>(batch, first, count, frames, offset);
}

template <class Value>
__attribute__((target("avx512f"))) void draw_avx512(const Batch& batch, Index first, Index count,
                                                    const Frames<Value>& frames, Index offset) {
  draw<16, 2, 8>(batch, first, count, frames, offset);
}
#endif

template <class Value>
void draw_with(Isa isa, const Batch& batch, Index first, Index count, const Frames<Value>& frames,
               Index offset) {
#if defined(__x86_64__)
  if (isa == Isa::avx512) return draw_avx512(batch, first, count, frames, offset);
  if (isa == Isa::avx2) return draw_avx2(batch, first, count, frames, offset);
#endif
  draw_plain(batch, first, count, frames, offset);
}

}  // namespace

void draw_bytes(const Batch& batch, Index first, Index count, const Frames<std::uint8_t>& frames, Isa isa) {
  draw_with(isa, batch, first, count, frames, first);
}

void draw_levels(const Batch& batch, Index first, Index count, const Frames<float>& frames, Isa isa) {
  draw_with(isa, batch, first, count, frames, 0);
}

std::uint8_t byte_of(float level) {
  std::uint8_t byte = 0;
  put(level, byte);
  return byte;
}

}  // namespace emberfold::dytex::detail
