// SPDX-License-Identifier: Apache-2.0
#include "pipeline/clip_measures.hpp"

#include <algorithm>
#include <numeric>

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "core/rng.hpp"
#include "dytex/measures/optical_flow.hpp"
#include "pipeline/clip_strokes.hpp"
#include "tests/dytex/baselines/made_waves.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;
using Catch::Matchers::WithinAbs;

namespace {

using Json = nlohmann::ordered_json;

constexpr int kFrames = 192;

pipeline::ClipMeasures measures_of(const core::Clip& clip) {
  pipeline::ClipMeasures measures({64, 64}, {32, 16, 32}, kFrames);
  measures.add(clip.frames, {});
  return measures;
}

core::Clip shuffled(const core::Clip& clip) {
  std::vector<std::size_t> order(clip.frames.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  core::Rng rng(2);
  for (std::size_t i = order.size(); i-- > 1;)
    std::swap(order[i], order[rng.below(static_cast<std::uint32_t>(i + 1))]);
  return changed(clip, [&](std::size_t t) { return clip.frames[order[t]]; });
}

// Blocks of 16 px from other moments.
cv::Mat seamed(const core::Clip& clip, std::size_t t) {
  cv::Mat out = clip.frames[t].clone();
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) {
      const cv::Rect block(16 * x, 16 * y, 16, 16);
      const auto other = (t + static_cast<std::size_t>(37 * (4 * y + x))) % clip.frames.size();
      clip.frames[other](block).copyTo(out(block));
    }
  return out;
}

}  // namespace

TEST_CASE("each fault of a texture shows in its own measures and another sample in none") {
  const auto source = waves(kFrames, 11);
  const auto truth = measures_of(source);
  const auto distance = [&](const core::Clip& clip) {
    return pipeline::pixel_distances(measures_of(clip), truth);
  };
  const auto sample = distance(waves(kFrames, 12));
  INFO("another sample: " << sample.dump());
  const auto far = [&](const Json& found, const char* key, double times) {
    // 0.02: where the sample is as good as the source
    return found[key].get<double>() > times * std::max(0.02, sample[key].get<double>());
  };
  const auto near = [&](const Json& found, const char* key) {
    return found[key].get<double>() < 2 * std::max(0.02, sample[key].get<double>());
  };
  CHECK(sample["temporal_db"] < 1.5);
  CHECK(sample["radial_db"] < 1.5);
  for (const char* key : {"autocorrelation", "patterns", "crease_sharpness", "si", "ti"})
    CHECK(sample[key] < 0.06);
  CHECK(sample["flow_px"] < 0.3);

  cv::Mat mean(64, 64, CV_32F, cv::Scalar(0));
  for (const auto& frame : source.frames) mean += frame / kFrames;
  const auto mean_image = distance(changed(source, [&](std::size_t) { return mean; }));
  INFO("mean image: " << mean_image.dump());
  for (const char* key : {"temporal_db", "radial_db", "autocorrelation", "patterns", "si", "ti"})
    CHECK(far(mean_image, key, 5));

  const auto frozen = distance(changed(source, [&](std::size_t) { return source.frames[40]; }));
  INFO("frozen: " << frozen.dump());
  for (const char* key : {"temporal_db", "autocorrelation", "patterns", "ti"}) CHECK(far(frozen, key, 5));
  CHECK(frozen["radial_db"] < mean_image["radial_db"]);
  CHECK(frozen["crease_sharpness"] < 0.2);

  const auto mixed = distance(shuffled(source));
  INFO("shuffled: " << mixed.dump());
  for (const char* key : {"temporal_db", "autocorrelation", "patterns", "ti"}) CHECK(far(mixed, key, 3));
  CHECK(mixed["radial_db"] < 0.01);
  CHECK(mixed["si"] < 0.01);

  const auto longer = waves(2 * kFrames, 12);
  const auto fast = distance(changed(source, [&](std::size_t t) { return longer.frames[2 * t]; }));
  INFO("double speed: " << fast.dump());
  for (const char* key : {"temporal_db", "autocorrelation", "patterns", "flow_px", "ti"})
    CHECK(far(fast, key, 2));
  CHECK(near(fast, "radial_db"));
  CHECK(near(fast, "si"));

  const auto back =
      distance(changed(source, [&](std::size_t t) { return source.frames[source.frames.size() - 1 - t]; }));
  INFO("reversed: " << back.dump());
  for (const char* key : {"temporal_db", "radial_db", "autocorrelation", "si", "ti"}) CHECK(near(back, key));
  for (const char* key : {"patterns", "flow_px"}) CHECK(far(back, key, 4));

  const auto blurred = distance(changed(source, [&](std::size_t t) {
    cv::Mat out;
    cv::GaussianBlur(source.frames[t], out, {}, 2);
    return out;
  }));
  INFO("blurred: " << blurred.dump());
  for (const char* key : {"radial_db", "crease_sharpness", "si"}) CHECK(far(blurred, key, 3));
  CHECK(far(blurred, "temporal_db", 1.5));

  const auto blocks = distance(changed(source, [&](std::size_t t) { return seamed(source, t); }));
  INFO("seamed: " << blocks.dump());
  CHECK(far(blocks, "radial_db", 5));
  CHECK(blocks["temporal_db"] < 1);
  CHECK(near(blocks, "autocorrelation"));

  const auto loop = distance(changed(source, [&](std::size_t t) { return source.frames[t % 40]; }));
  INFO("looped: " << loop.dump());
  CHECK(loop["temporal_db"] > sample["temporal_db"]);
  CHECK(loop["radial_db"] < frozen["radial_db"]);
  CHECK(loop["temporal_db"] < frozen["temporal_db"]);
}

TEST_CASE("optical flow sees where a texture goes") {
  const auto clip = waves(2, 5);
  cv::Mat base = clip.frames[0], moved, large, large_moved;
  const cv::Mat shift = (cv::Mat_<double>(2, 3) << 1, 0, 1.5, 0, 1, -1);
  cv::warpAffine(base, moved, shift, base.size(), cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  const auto middle = [](const cv::Mat& flow) {
    return cv::mean(flow(cv::Rect(flow.cols / 4, flow.rows / 4, flow.cols / 2, flow.rows / 2)));
  };
  const auto flow = middle(dytex::optical_flow(base, moved));
  CHECK_THAT(flow[0], WithinAbs(1.5, 0.15));
  CHECK_THAT(flow[1], WithinAbs(-1, 0.15));
  // Frames above 2^16 pixels are reduced; their motion is told in their own pixels.
  cv::resize(base, large, {512, 512}, 0, 0, cv::INTER_CUBIC);
  cv::resize(moved, large_moved, {512, 512}, 0, 0, cv::INTER_CUBIC);
  const auto large_flow = middle(dytex::optical_flow(large, large_moved));
  CHECK_THAT(large_flow[0], WithinAbs(12, 2));
  CHECK_THAT(large_flow[1], WithinAbs(-8, 1.5));
  CHECK(cv::norm(dytex::optical_flow(cv::Mat(3, 3, CV_32F, cv::Scalar(1)),
                                     cv::Mat(3, 3, CV_32F, cv::Scalar(9)))) == 0);
}

TEST_CASE("stroke distances are ratios and say what lies in the source's interval") {
  mcmc::StrokeStatistics a, b;
  a.frames = 101, b.frames = 201;
  for (std::size_t i = 0; i < 6; ++i) {
    a.happened[i] = 10, b.happened[i] = 20.5;  // half an event apart: the same rates
    a.events_a_frame[i] = {0.1, 0.05, 0.2}, b.events_a_frame[i] = {0.1025, 0.08, 0.12};
  }
  a.lifetime = {20, 15, 30}, b.lifetime = {10, 8, 12};
  const auto found = pipeline::stroke_distances(a, b);
  CHECK_THAT(found["stroke_events"].get<double>(), WithinAbs(0, 1e-9));
  CHECK_THAT(found["stroke_lifetime"].get<double>(), WithinAbs(std::log(2.0), 1e-3));
  CHECK(found["stroke_length"].is_null());
  CHECK(found["inside"]["birth"] == true);
  CHECK(found["inside"]["lifetime"] == false);
}
