// SPDX-License-Identifier: Apache-2.0
#include "dytex/draw_frames.hpp"

#include <cstring>

namespace emberfold::dytex::detail {

namespace {

using Eigen::Index;

// 1.5 · 2²³: a float of this size has no places behind the point, so that adding it rounds; the value is then
// in the last byte.
constexpr float kRounder = 12582912.0F;

// Vectors of so many lanes, and what reads and writes them where they lie.
template <int kLanes>
struct Lanes;
template <>
struct Lanes<4> {
  using Float = float __attribute__((vector_size(16)));
  using Int = std::int32_t __attribute__((vector_size(16)));
  using Byte = std::uint8_t __attribute__((vector_size(4)));
};
template <>
struct Lanes<8> {
  using Float = float __attribute__((vector_size(32)));
  using Int = std::int32_t __attribute__((vector_size(32)));
  using Byte = std::uint8_t __attribute__((vector_size(8)));
};
template <>
struct Lanes<16> {
  using Float = float __attribute__((vector_size(64)));
  using Int = std::int32_t __attribute__((vector_size(64)));
  using Byte = std::uint8_t __attribute__((vector_size(16)));
};

// Everything below is inlined into functions compiled for one kind of vectors, and nothing passes a vector by
// value, whose way of passing depends on that.
#define EMBERFOLD_INLINE [[gnu::always_inline]] inline

/// `kFrames` frames from `frame` on of kVectors · kLanes values from `row` on. The sums stay in registers: as
/// many of them as the processor has, less what holds a column's values and a state.
template <int kLanes, int kVectors, int kFrames>
struct Tile {
  using Float = typename Lanes<kLanes>::Float;
  static constexpr Index kRows = kVectors * kLanes;
  Float sums[kFrames][kVectors];

  EMBERFOLD_INLINE static void load(const float* from, Float (&to)[kVectors]) {
#pragma GCC unroll 4
    for (int v = 0; v < kVectors; ++v) std::memcpy(&to[v], from + v * kLanes, sizeof to[v]);
  }

  EMBERFOLD_INLINE void draw(const Batch& batch, Index row, Index frame) {
    constexpr Index kAhead =
        256;  // values, that is 1 KiB of each column, of which there are too many to guess
    Float column[kVectors];
    load(batch.mean + row, column);
#pragma GCC unroll 8
    for (int f = 0; f < kFrames; ++f)
#pragma GCC unroll 4
      for (int v = 0; v < kVectors; ++v) sums[f][v] = column[v];
    const float* values = batch.C + row;
    const float* states = batch.states + frame;
    for (Index k = 0; k < batch.components; ++k, values += batch.values, states += kBatch) {
      load(values, column);
      if (frame == 0)
        for (Index ahead = 0; ahead < kRows; ahead += 16) __builtin_prefetch(values + kAhead + ahead);
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
      const auto bytes = __builtin_convertvector(bits, typename Lanes<kLanes>::Byte);
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

/// frames[i] + offset gets the values.
template <int kLanes, int kVectors, int kFrames, class Value>
EMBERFOLD_INLINE void draw(const Batch& batch, Index first, Index count,
                           const std::array<Value*, kBatch>& frames, Index offset) {
  using Rows = Tile<kLanes, kVectors, kFrames>;
  Index done = 0;
  for (; done + Rows::kRows <= count; done += Rows::kRows)
    for (Index frame = 0; frame < kBatch; frame += kFrames) {
      Rows tile;
      tile.draw(batch, first + done, frame);
#pragma GCC unroll 8
      for (int f = 0; f < kFrames; ++f)
        tile.store(f, frames[static_cast<std::size_t>(frame + f)] + offset + done);
    }
  for (; done < count; ++done)
    for (Index frame = 0; frame < kBatch; ++frame) {
      float level = batch.mean[first + done];
      for (Index k = 0; k < batch.components; ++k)
        level = level + batch.C[k * batch.values + first + done] * batch.states[k * kBatch + frame];
      put(level, frames[static_cast<std::size_t>(frame)][offset + done]);
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
void draw_with(Vectors vectors, const Batch& batch, Index first, Index count, const Frames<Value>& frames,
               Index offset) {
#if defined(__x86_64__)
  if (vectors == Vectors::avx512) return draw_avx512(batch, first, count, frames, offset);
  if (vectors == Vectors::avx2) return draw_avx2(batch, first, count, frames, offset);
#endif
  draw_plain(batch, first, count, frames, offset);
}

}  // namespace

std::span<const Vectors> available_vectors() {
  static constexpr std::array kAll{Vectors::plain, Vectors::avx2, Vectors::avx512};
#if defined(__x86_64__)
  static const std::size_t count = __builtin_cpu_supports("avx2") == 0      ? 1
                                   : __builtin_cpu_supports("avx512f") == 0 ? 2
                                                                            : 3;
#else
  static const std::size_t count = 1;
#endif
  return std::span(kAll).first(count);
}

void draw_bytes(const Batch& batch, Index first, Index count, const Frames<std::uint8_t>& frames,
                Vectors vectors) {
  draw_with(vectors, batch, first, count, frames, first);
}

void draw_levels(const Batch& batch, Index first, Index count, const Frames<float>& frames, Vectors vectors) {
  draw_with(vectors, batch, first, count, frames, 0);
}

std::uint8_t byte_of(float level) {
  std::uint8_t byte = 0;
  put(level, byte);
  return byte;
}

}  // namespace emberfold::dytex::detail
