// SPDX-License-Identifier: Apache-2.0
#include "pipeline/comparison/clip_measures.hpp"

#include <algorithm>
#include <numeric>
#include <sstream>
#include <string>

#include <opencv2/imgproc.hpp>

#include "core/rng.hpp"
#include "dytex/measures/optical_flow.hpp"
#include "dytex/measures/spectra.hpp"
#include "pipeline/comparison/clip_strokes.hpp"
#include "tests/dytex/baselines/made_waves.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

using Distances = pipeline::PixelDistances;
using Field = double Distances::*;

constexpr int kMeasuredFrames = 192;

pipeline::ClipMeasures measures_of(const core::Clip& clip) {
  pipeline::ClipMeasures measures({64, 64}, {32, 16, 32}, kMeasuredFrames);
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

std::string text(const Distances& d) {
  std::ostringstream out;
  for (const double value :
       {d.temporal_db, d.radial_db, d.autocorrelation, d.patterns, d.flow_px, d.crease_sharpness, d.si, d.ti})
    out << value << ' ';
  return out.str();
}

}  // namespace

TEST_CASE("each fault of a texture shows in its own measures and another sample in none") {
  const auto source = waves(kMeasuredFrames, 11);
  const auto truth = measures_of(source);
  const auto distance = [&](const core::Clip& clip) {
    return pipeline::pixel_distances(measures_of(clip), truth);
  };
  const auto sample = distance(waves(kMeasuredFrames, 12));
  INFO("another sample: " << text(sample));
  const auto far = [&](const Distances& found, Field field, double times) {
    // 0.02: where the sample is as good as the source
    return found.*field > times * std::max(0.02, sample.*field);
  };
  const auto near = [&](const Distances& found, Field field) {
    return found.*field < 2 * std::max(0.02, sample.*field);
  };
  CHECK(sample.temporal_db < 1.5);
  CHECK(sample.radial_db < 1.5);
  for (const Field field : {&Distances::autocorrelation, &Distances::patterns, &Distances::crease_sharpness,
                            &Distances::si, &Distances::ti})
    CHECK(sample.*field < 0.06);
  CHECK(sample.flow_px < 0.3);

  cv::Mat mean(64, 64, CV_32F, cv::Scalar(0));
  for (const auto& frame : source.frames) mean += frame / kMeasuredFrames;
  const auto mean_image = distance(changed(source, [&](std::size_t) { return mean; }));
  INFO("mean image: " << text(mean_image));
  for (const Field field : {&Distances::temporal_db, &Distances::radial_db, &Distances::autocorrelation,
                            &Distances::patterns, &Distances::si, &Distances::ti})
    CHECK(far(mean_image, field, 5));

  const auto frozen = distance(changed(source, [&](std::size_t) { return source.frames[40]; }));
  INFO("frozen: " << text(frozen));
  for (const Field field :
       {&Distances::temporal_db, &Distances::autocorrelation, &Distances::patterns, &Distances::ti})
    CHECK(far(frozen, field, 5));
  CHECK(frozen.radial_db < mean_image.radial_db);
  CHECK(frozen.crease_sharpness < 0.2);

  const auto mixed = distance(shuffled(source));
  INFO("shuffled: " << text(mixed));
  for (const Field field :
       {&Distances::temporal_db, &Distances::autocorrelation, &Distances::patterns, &Distances::ti})
    CHECK(far(mixed, field, 3));
  CHECK(mixed.radial_db < 0.01);
  CHECK(mixed.si < 0.01);

  const auto longer = waves(2 * kMeasuredFrames, 12);
  const auto fast = distance(changed(source, [&](std::size_t t) { return longer.frames[2 * t]; }));
  INFO("double speed: " << text(fast));
  for (const Field field : {&Distances::temporal_db, &Distances::autocorrelation, &Distances::patterns,
                            &Distances::flow_px, &Distances::ti})
    CHECK(far(fast, field, 2));
  CHECK(near(fast, &Distances::radial_db));
  CHECK(near(fast, &Distances::si));

  const auto back =
      distance(changed(source, [&](std::size_t t) { return source.frames[source.frames.size() - 1 - t]; }));
  INFO("reversed: " << text(back));
  for (const Field field : {&Distances::temporal_db, &Distances::radial_db, &Distances::autocorrelation,
                            &Distances::si, &Distances::ti})
    CHECK(near(back, field));
  for (const Field field : {&Distances::patterns, &Distances::flow_px}) CHECK(far(back, field, 4));

  const auto blurred = distance(changed(source, [&](std::size_t t) {
    cv::Mat out;
    cv::GaussianBlur(source.frames[t], out, {}, 2);
    return out;
  }));
  INFO("blurred: " << text(blurred));
  for (const Field field : {&Distances::radial_db, &Distances::crease_sharpness, &Distances::si})
    CHECK(far(blurred, field, 3));
  CHECK(far(blurred, &Distances::temporal_db, 1.5));

  const auto blocks = distance(changed(source, [&](std::size_t t) { return seamed(source, t); }));
  INFO("seamed: " << text(blocks));
  CHECK(far(blocks, &Distances::radial_db, 5));
  CHECK(blocks.temporal_db < 1);
  CHECK(near(blocks, &Distances::autocorrelation));

  const auto loop = distance(changed(source, [&](std::size_t t) { return source.frames[t % 40]; }));
  INFO("looped: " << text(loop));
  CHECK(loop.temporal_db > sample.temporal_db);
  CHECK(loop.radial_db < frozen.radial_db);
  CHECK(loop.temporal_db < frozen.temporal_db);
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
  CHECK_THAT(found.event_rates, WithinAbs(0, 1e-9));
  CHECK_THAT(found.lifetime.value(), WithinAbs(std::log(2.0), 1e-3));
  CHECK(!found.length);
  CHECK(found.rate_inside[static_cast<std::size_t>(graph::EventType::birth)]);
  CHECK(!found.lifetime_inside);
}

TEST_CASE("A clip's measures are the same however its frames come") {
  const auto clip = noise_clip({40, 30}, 24, 3);
  core::ClipSource source(clip);
  const pipeline::MeasureScale scale{8, 4, 15};
  pipeline::ClipMeasures measures({40, 30}, scale, 24), at_once({40, 30}, scale, 24);
  std::vector<cv::Mat> luma;
  for (const auto& frame : clip.frames) luma.push_back(core::luma(frame, clip.info));
  measures.add(std::span(luma).first(5), {});
  measures.add(std::span(luma).subspan(5), {});
  at_once.add(luma, {});
  CHECK(measures.temporal() == dytex::temporal_spectrum(source, 8));
  CHECK(measures.radial() == dytex::radial_spectrum(source, 15));
  CHECK(measures.figures() == at_once.figures());
  CHECK(pipeline::pixel_distances(measures, at_once) == Distances{});
  CHECK(pipeline::measure_scale(64, {40, 30}).segment == 32);
  CHECK(pipeline::measure_scale(31, {40, 30}).segment == 16);
  CHECK(pipeline::measure_scale(31, {40, 30}).lags == 7);
  CHECK(pipeline::measure_scale(4, {40, 30}).segment == 4);
}

TEST_CASE("Large frames have the spectrum in time of all their pixels") {
  const cv::Size size(900, 700);
  const auto clip = noise_clip(size, 8, 5, 101);
  pipeline::ClipMeasures measures(size, {4, 1, 64}, 8000);
  for (const auto& frame : clip.frames) {
    const auto luma = core::luma(frame, clip.info);
    measures.add(std::span(&luma, 1), {});
  }
  // uniform on 0 … 100: a variance of (101² − 1) / 12
  CHECK_THAT(measures.temporal()(1), WithinAbs(850, 20));
}

TEST_CASE("Large frames are sampled all over") {
  // The lower half flickers by ±20, the upper one is still.
  const cv::Size size(900, 700);
  pipeline::ClipMeasures measures(size, {4, 1, 64}, 8000);
  for (int t = 0; t < 8; ++t) {
    cv::Mat luma(size, CV_32F, cv::Scalar(100));
    luma.rowRange(350, 700).setTo(t % 2 == 0 ? 120 : 80);
    measures.add(std::span(&luma, 1), {});
  }
  pipeline::ClipMeasures whole({90, 70}, {4, 1, 16}, 8000);  // the same, small enough for all pixels
  for (int t = 0; t < 8; ++t) {
    cv::Mat luma(70, 90, CV_32F, cv::Scalar(100));
    luma.rowRange(35, 70).setTo(t % 2 == 0 ? 120 : 80);
    whole.add(std::span(&luma, 1), {});
  }
  CHECK(whole.temporal()(1) > 50);
  CHECK_THAT(measures.temporal()(1), WithinRel(whole.temporal()(1), 0.01));
}
