// SPDX-License-Identifier: Apache-2.0
// Every instruction set that this machine has gives the same.
#include "dytex/learning/kernels.hpp"

#include <vector>

#include "tests/support/catch.hpp"
#include "tests/support/matrices.hpp"

using namespace emberfold;
using namespace emberfold::dytex::detail;

namespace {

std::vector<Isa> sets() {
  std::vector<Isa> result{Isa::baseline};
  if (best_isa() != Isa::baseline) result.push_back(Isa::avx2);
  if (best_isa() == Isa::avx512) result.push_back(Isa::avx512);
  return result;
}

std::vector<float> random_floats(std::size_t count, std::uint64_t seed) {
  core::Rng rng(seed);
  std::vector<float> result(count);
  for (float& x : result) x = static_cast<float>(rng.normal());
  return result;
}

double at(const Slices& slices, std::size_t i, std::size_t j) {
  return static_cast<double>(slices.data[(i / kSlice * slices.columns + j) * kSlice + i % kSlice]);
}

}  // namespace

TEST_CASE("Sums of products of bytes are exact on every instruction set", "[dytex][kernels]") {
  core::Rng rng(3);
  for (const std::uint32_t least : {0U, 255U}) {  // random, and as large as they get
    std::vector<std::int16_t> left(kDotLeft * kDotLength), right(kDotRight * kDotLength);
    for (auto* rows : {&left, &right})
      for (auto& x : *rows) x = static_cast<std::int16_t>(least + rng.below(256 - least));
    for (const Isa isa : sets()) {
      std::vector<double> sums(5 * kDotRight, 1);
      add_dot_products(isa, left.data(), right.data(), sums.data(), 5);
      for (std::size_t b = 0; b < kDotRight; ++b)
        for (std::size_t a = 0; a < 5; ++a) {
          std::int64_t sum = 1;
          for (std::size_t p = 0; a < kDotLeft && p < kDotLength; ++p)
            sum += std::int64_t{left[a * kDotLength + p]} * right[b * kDotLength + p];
          CHECK(sums[b * 5 + a] == static_cast<double>(sum));
        }
    }
  }
}

TEST_CASE("Products in slices are right and the same with every set that has FMA", "[dytex][kernels]") {
  constexpr std::size_t kStride = 100;
  for (const std::size_t columns : {1, 5, 6, 7, 13}) {
    for (const std::size_t depth : {1, 64}) {
      const std::size_t panels = (columns + kPanel - 1) / kPanel;
      const auto left = random_floats(3 * kSlice * depth, 1),
                 right = random_floats(panels * kPanel * depth, 2),
                 start = random_floats(kStride * panels * kPanel, 4);
      const Slices slices{left.data(), 3, depth};
      std::vector<std::vector<float>> found;
      for (const Isa isa : sets()) {
        found.push_back(start);
        add_product(isa, slices, right.data(), columns, found.back().data(), kStride);
        double worst = 0;
        for (std::size_t j = 0; j < columns; ++j)
          for (std::size_t i = 0; i < kStride; ++i) {
            double sum = static_cast<double>(start[j * kStride + i]);
            for (std::size_t t = 0; i < 3 * kSlice && t < depth; ++t)
              sum += at(slices, i, t) *
                     static_cast<double>(right[(j / kPanel * depth + t) * kPanel + j % kPanel]);
            worst = std::max(worst, std::abs(sum - static_cast<double>(found.back()[j * kStride + i])));
          }
        INFO(columns << " columns, depth " << depth << ", set " << static_cast<int>(isa));
        CHECK(worst < 2e-5);
      }
      if (found.size() == 3) CHECK(found[1] == found[2]);
    }
  }
}

TEST_CASE("Inner products of columns are right", "[dytex][kernels]") {
  for (const std::size_t n : {1, 2, 3, 4, 5, 12, 17}) {
    const auto data = random_floats(4 * kSlice * n, 5);
    const Slices slices{data.data(), 4, n};
    for (const Isa isa : sets()) {
      std::vector<double> products(n * n, 0);
      add_inner_products(isa, slices, products.data());
      for (std::size_t j = 0; j < n; ++j)
        for (std::size_t i = 0; i < n; ++i) {
          double sum = 0;
          for (std::size_t p = 0; i >= j && p < 4 * kSlice; ++p) sum += at(slices, p, i) * at(slices, p, j);
          CHECK(std::abs(products[j * n + i] - sum) < 2e-5);
        }
    }
  }
}
