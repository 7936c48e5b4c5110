// SPDX-License-Identifier: Apache-2.0
#include "dytex/learning/gram.hpp"

#include <cstdint>
#include <stop_token>

#include "tests/support/catch.hpp"
#include "tests/support/matrices.hpp"

using namespace emberfold;
using dytex::detail::FrameValues;

namespace {

/// Frames of random values of `count` each.
template <class Value>
std::vector<std::vector<Value>> random_frames(std::size_t frames, std::size_t count, std::uint32_t most) {
  core::Rng rng(7);
  std::vector<std::vector<Value>> result(frames, std::vector<Value>(count));
  for (auto& frame : result)
    for (Value& value : frame) value = static_cast<Value>(rng.below(most + 1));
  return result;
}

template <class Value>
FrameValues values_of(const std::vector<std::vector<Value>>& frames, std::size_t begin, std::size_t end,
                      int depth) {
  FrameValues values{{}, end - begin, depth};
  for (const auto& frame : frames) values.frames.push_back(frame.data() + begin);
  return values;
}

template <class Value>
bool exact(const std::vector<std::vector<Value>>& frames, const Eigen::MatrixXd& gram) {
  for (std::size_t i = 0; i < frames.size(); ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      std::int64_t sum = 0;
      for (std::size_t p = 0; p < frames[i].size(); ++p) sum += std::int64_t{frames[i][p]} * frames[j][p];
      if (gram(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) != static_cast<double>(sum))
        return false;
    }
  return true;
}

}  // namespace

TEST_CASE("The Gram matrix of bytes is exact at every number of frames and values", "[dytex][gram]") {
  for (const std::size_t frames : {1, 2, 3, 7, 47, 48, 49, 101}) {
    for (const std::size_t count : {1, 7, 8, 255, 256, 257, 1000}) {
      const auto data = random_frames<std::uint8_t>(frames, count, 255);
      Eigen::MatrixXd gram =
          Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(frames), static_cast<Eigen::Index>(frames));
      add_gram(values_of(data, 0, count, CV_8U), gram, {});
      INFO(frames << " frames of " << count);
      CHECK(exact(data, gram));
    }
  }
}

TEST_CASE("The Gram matrix of white bytes does not overflow", "[dytex][gram]") {
  const std::vector<std::vector<std::uint8_t>> white(5, std::vector<std::uint8_t>(200000, 255));
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(5, 5);
  add_gram(values_of(white, 0, 200000, CV_8U), gram, {});
  CHECK(exact(white, gram));
}

TEST_CASE("The Gram matrix of 16-bit values is exact", "[dytex][gram]") {
  const auto data = random_frames<std::uint16_t>(60, 1000, 65535);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(60, 60);
  add_gram(values_of(data, 0, 1000, CV_16U), gram, {});
  CHECK(exact(data, gram));
}

TEST_CASE("Parts of whole blocks give the same bits as all values at once", "[dytex][gram]") {
  auto data = random_frames<float>(50, 1100, 1000000);
  for (auto& frame : data)
    for (float& value : frame) value /= 999983;
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(50, 50), in_parts = whole;
  add_gram(values_of(data, 0, 1100, CV_32F), whole, {});
  for (const auto& [begin, end] : {std::pair{0, 512}, {512, 768}, {768, 1100}})
    add_gram(values_of(data, static_cast<std::size_t>(begin), static_cast<std::size_t>(end), CV_32F),
             in_parts, {});
  CHECK(whole == in_parts);
}

TEST_CASE("Centring the Gram matrix equals that of centred frames", "[dytex][gram]") {
  const Eigen::MatrixXd frames = (test::normals(40, 9, 3).array() * 10 + 50).matrix();
  const Eigen::MatrixXd less_mean = frames.colwise() - frames.rowwise().mean();
  Eigen::MatrixXd gram = frames.transpose() * frames;
  gram.triangularView<Eigen::StrictlyUpper>().setConstant(1e9);  // must not be read
  CHECK((dytex::detail::centred(gram) - less_mean.transpose() * less_mean).norm() < 1e-9);
}

TEST_CASE("A cancelled Gram matrix throws", "[dytex][gram]") {
  const auto data = random_frames<std::uint8_t>(60, 1000, 255);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(60, 60);
  std::stop_source stop;
  stop.request_stop();
  CHECK_THROWS_AS(add_gram(values_of(data, 0, 1000, CV_8U), gram, core::Context(stop.get_token())),
                  core::Cancelled);
}
