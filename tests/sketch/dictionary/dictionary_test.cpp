// SPDX-License-Identifier: Apache-2.0
#include "sketch/dictionary/dictionary.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/rng.hpp"
#include "sketch/extract.hpp"
#include "sketch/inpainting/fill.hpp"
#include "sketch/refinement/coding_length.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::sketch;
using namespace emberfold::test;
using graph::PatchType;

namespace {

using Shape = std::vector<float>;

Shape shape(const std::function<double(double)>& value) {
  Shape all;
  double mean = 0, square = 0;
  for (std::size_t i = 0; i < kProfileSamples; ++i)
    all.push_back(static_cast<float>(value(2.0 * double(i) / (kProfileSamples - 1) - 1)));
  for (const float v : all) mean += double{v} / kProfileSamples;
  for (float& v : all) square += (double{v} - mean) * (double{v} - mean) / kProfileSamples;
  for (float& v : all) v = static_cast<float>((double{v} - mean) / std::sqrt(square));
  return all;
}

double product(const Shape& a, const Shape& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += double{a[i]} * double{b[i]};
  return sum / static_cast<double>(a.size());
}

// A view of the shape at some level and contrast, in white noise.
PatchView seen_view(const Shape& of, std::uint32_t vertex, core::Rng& rng, double noise) {
  PatchView view;
  view.vertex = {vertex};
  view.degree = 2;
  view.reach = 12;
  const double level = rng.uniform(40, 200), contrast = rng.uniform(10, 40);
  for (const float v : of)
    view.luma.push_back(static_cast<float>(level + contrast * (double{v} + noise * rng.normal())));
  return view;
}

// Crossing and bent lines and a blob, as their own sketch shows them.
struct DrawnFrame {
  graph::AttributeGraph graph;
  cv::Mat levels;
};
DrawnFrame drawn(double noise = 0, double shift = 0) {
  const double d = shift;
  const std::vector<test::Cover> shapes = {
      test::segment({20 + d, 30}, {180, 50 + d}, 4, 1), test::segment({60 + d, 10}, {80 + d, 150}, 5, 1.2),
      test::ring({140, 105 + d}, 32, 4, 1), test::segment({15, 120 + d}, {100, 110 - d}, 7, 1.5)};
  const cv::Mat1f frame = test::draw({200, 160}, shapes, 60, 110);
  DrawnFrame result{extract(frame, {}), {}};
  const auto part = draw_fitted(result.graph, frame.size(), 1);
  result.levels = fill(part.levels, part.mask).levels;
  if (noise > 0) result.levels = test::with_noise(result.levels, noise, 3);
  return result;
}

Dictionary learned_from(const DrawnFrame& from) {
  DictionaryLearner learner;
  learner.add(0, view_patches(from.levels, from.graph));
  return learner.learn();
}

double rms(const cv::Mat& a, const cv::Mat& b, const cv::Mat& mask) {
  return cv::norm(a, b, cv::NORM_L2, mask) / std::sqrt(double(cv::countNonZero(mask)));
}

const Shape kNarrow = shape([](double d) { return std::exp(-18 * d * d); });
const Shape kSkew = shape([](double d) { return std::exp(-9 * (d + 0.3) * (d + 0.3)) + 0.8 * d; });

}  // namespace

TEST_CASE("Two planted profiles of one type become two entries") {
  core::Rng rng(5);
  DictionaryLearner learner;
  std::vector<PatchView> all;
  for (std::uint32_t i = 0; i < 500; ++i) all.push_back(seen_view(i % 5 < 3 ? kNarrow : kSkew, i, rng, 0.15));
  learner.add(0, all);
  const Dictionary dictionary = learner.learn();
  REQUIRE(dictionary.entries.size() == 2);
  CHECK(product(dictionary.entries[0].mean, kNarrow) > 0.998);
  CHECK(product(dictionary.entries[1].mean, kSkew) > 0.998);
  CHECK(dictionary.entries[0].seen == 300);
  CHECK_THAT(dictionary.entries[1].share, WithinAbs(0.4, 1e-12));
  for (const DictionaryEntry& entry : dictionary.entries) {
    CHECK(entry.components.empty());
    CHECK_THAT(entry.residual, WithinAbs(0.15 / std::sqrt(1 + 0.15 * 0.15), 0.01));
  }
  CHECK_NOTHROW(validate(dictionary));
}

TEST_CASE("A planted way to vary is found as the one component") {
  core::Rng rng(6);
  // Variation besides the mean, orthogonal to it.
  Shape way = shape([](double d) { return std::sin(5 * d); });
  const double along = product(way, kNarrow);
  for (std::size_t i = 0; i < way.size(); ++i) way[i] -= static_cast<float>(along) * kNarrow[i];
  const double length = std::sqrt(product(way, way));
  for (float& v : way) v /= static_cast<float>(length);
  std::vector<PatchView> all;
  double squares = 0;  // of the coefficient, the view's contrast taken off
  for (std::uint32_t i = 0; i < 600; ++i) {
    Shape varied = kNarrow;
    const auto by = static_cast<float>(0.25 * rng.normal());
    squares += double{by * by} / (1 + double{by * by} + 0.05 * 0.05);
    for (std::size_t j = 0; j < varied.size(); ++j) varied[j] += by * way[j];
    all.push_back(seen_view(varied, i, rng, 0.05));
  }
  DictionaryLearner learner;
  learner.add(0, all);
  const Dictionary dictionary = learner.learn();
  REQUIRE(dictionary.entries.size() == 1);
  const DictionaryEntry& entry = dictionary.entries[0];
  REQUIRE(entry.components.size() == 1);
  CHECK(std::abs(product(entry.components[0], way)) > 0.99);
  CHECK_THAT(entry.spread[0], WithinAbs(std::sqrt(squares / 600), 0.01));
  CHECK(entry.residual < 0.06);
}

TEST_CASE("Learning depends on neither threads nor the order of frames, and holds a bounded sample") {
  core::Rng rng(7);
  std::vector<std::vector<PatchView>> frames;
  for (int t = 0; t < 12; ++t) {
    frames.emplace_back();
    for (std::uint32_t i = 0; i < 400; ++i) {
      frames.back().push_back(seen_view(i % 2 == 0 ? kNarrow : kSkew, i, rng, 0.3));
      frames.back().back().type = i % 4 < 2 ? PatchType::ridge : PatchType::bar;
    }
  }
  const auto learn = [&](std::size_t threads, bool backwards, std::uint64_t seed) {
    const core::ThreadLimit limit(threads);
    DictionaryLearner learner(seed);
    for (std::uint32_t t = 0; t < 12; ++t) {
      const std::uint32_t frame = backwards ? 11 - t : t;
      learner.add(frame, frames[frame]);
    }
    return learner.learn();
  };
  const Dictionary first = learn(1, false, 1);
  CHECK(first == learn(4, false, 1));
  CHECK(first == learn(4, true, 1));
  CHECK(first.entries.size() == 4);

  DictionaryLearner much;
  std::vector<PatchView> many;
  for (std::uint32_t i = 0; i < 5000; ++i) many.push_back(seen_view(kNarrow, i, rng, 0.1));
  much.add(0, many);
  CHECK(much.stored() == 4096);
  CHECK(much.learn().entries.front().seen == 5000);
}

TEST_CASE("Even views and those that are not finite teach nothing") {
  PatchView even;
  even.degree = 2;
  even.luma.assign(kProfileSamples, 80.0F);
  DictionaryLearner learner;
  learner.add(0, std::vector<PatchView>{even});
  CHECK(learner.stored() == 0);
  CHECK(learner.learn().entries.empty());

  DrawnFrame made = drawn();
  made.levels.setTo(std::numeric_limits<float>::quiet_NaN());
  for (const PatchView& view : view_patches(made.levels, made.graph)) CHECK(view.luma.empty());
  for (const PatchCode& code : encode(made.levels, made.graph, Dictionary{}, 1))
    CHECK(code.entry == PatchCode::kNone);
}

TEST_CASE("Codes follow level and contrast and do not mind the way that a curve is followed") {
  const DrawnFrame made = drawn(1.5);
  REQUIRE(made.graph.size() > 40);
  const Dictionary dictionary = learned_from(made);
  const auto codes = encode(made.levels, made.graph, dictionary, 1.5);

  cv::Mat fainter = made.levels * 0.5 + 30;
  const auto faint = encode(fainter, made.graph, dictionary, 0.75);
  auto vertices = std::vector<graph::Vertex>(made.graph.vertices().begin(), made.graph.vertices().end());
  for (auto& vertex : vertices) {
    vertex.patch.theta += vertex.patch.theta > 0 ? -std::numbers::pi : std::numbers::pi;
    std::swap(vertex.patch.left, vertex.patch.right);
    if (graph::on_step(vertex.patch)) vertex.patch.contrast = -vertex.patch.contrast;
  }
  const graph::AttributeGraph turned_graph(
      vertices, std::vector<graph::Edge>(made.graph.edges().begin(), made.graph.edges().end()));
  const auto reversed = encode(made.levels, turned_graph, dictionary, 1.5);
  std::size_t coded = 0;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    INFO(i);
    CHECK(faint[i].entry == codes[i].entry);
    CHECK(reversed[i].entry == codes[i].entry);
    if (codes[i].entry == PatchCode::kNone) continue;
    ++coded;
    CHECK(faint[i].numbers == codes[i].numbers);
    CHECK_THAT(double(faint[i].level[0]), WithinAbs(0.5 * double(codes[i].level[0]) + 30, 1e-2));
    CHECK_THAT(double(faint[i].amplitude[0]), WithinAbs(0.5 * double(codes[i].amplitude[0]), 1e-2));
    CHECK_THAT(faint[i].residual, WithinAbs(0.5 * codes[i].residual, 1e-2));
    CHECK_THAT(faint[i].cost, WithinAbs(codes[i].cost, 1e-9));
    CHECK(reversed[i].reversed != codes[i].reversed);
    CHECK_THAT(double(reversed[i].amplitude[0]), WithinAbs(double(codes[i].amplitude[0]), 1e-2));
    CHECK_THAT(reversed[i].residual, WithinAbs(codes[i].residual, 1e-2));
    REQUIRE(reversed[i].parametric.has_value() == codes[i].parametric.has_value());
    if (codes[i].parametric) CHECK_THAT(*reversed[i].parametric, WithinAbs(*codes[i].parametric, 1e-2));
  }
  CHECK(coded * 20 >= codes.size() * 19);
  const auto there = draw_learned(made.graph, codes, dictionary, made.levels.size(), 1);
  const auto back = draw_learned(turned_graph, reversed, dictionary, made.levels.size(), 1);
  CHECK(cv::norm(there.levels, back.levels, cv::NORM_INF) < 0.05);
}

TEST_CASE("A code costs its numbers and its entry's share") {
  const DrawnFrame made = drawn(1);
  const Dictionary dictionary = learned_from(made);
  for (const double noise : {0.3, 3.0, 300.0}) {
    const auto codes = encode(made.levels, made.graph, dictionary, noise);
    const auto all = view_patches(made.levels, made.graph);
    int told = 0;
    for (std::size_t i = 0; i < codes.size(); ++i) {
      if (codes[i].entry == PatchCode::kNone) continue;
      const DictionaryEntry& entry = dictionary.entries.at(codes[i].entry);
      const double side = all[i].type == PatchType::blob ? 2 * all[i].reach : 3 * all[i].reach;
      const double pixels = entry.window() ? side * side : 10 * all[i].reach;
      CHECK_THAT(codes[i].cost,
                 WithinAbs(0.5 * (5 + codes[i].numbers) * std::log1p(pixels) - std::log(entry.share) +
                               std::log1p(double(entry.components.size())),
                           1e-9));
      CHECK_THAT(codes[i].parametric_cost, WithinAbs(coding_cost(made.graph.patch(i), pixels), 1e-9));
      told += codes[i].numbers;
      // Residual, computed from the code.
      double squares = 0;
      for (std::size_t j = 0; j < all[i].luma.size(); ++j) {
        double level = double(codes[i].level[0]) + double(codes[i].amplitude[0]) * double{entry.mean[j]};
        for (std::size_t k = 0; k < std::size_t(codes[i].numbers); ++k)
          level += double(codes[i].coefficients[k][0]) * double{entry.components[k][j]};
        squares += std::pow(double{all[i].luma[j]} - level, 2);
      }
      CHECK_THAT(codes[i].residual, WithinAbs(std::sqrt(squares / double(all[i].luma.size())), 0.05));
    }
    // In much noise no coefficient pays.
    if (noise > 100) CHECK(told == 0);
    if (noise < 1) CHECK(told > 0);
  }
}

TEST_CASE("A frame that was drawn from attributes is drawn again by what is learned from it") {
  const DrawnFrame made = drawn();
  DictionaryLearner learner;
  for (std::uint32_t frame = 0; frame < 12; ++frame) {
    const DrawnFrame other = drawn(0, 0.4 * frame);
    learner.add(frame, view_patches(other.levels, other.graph));
  }
  const Dictionary dictionary = learner.learn();
  const auto codes = encode(made.levels, made.graph, dictionary, 0.3);
  const auto fitted = draw_fitted(made.graph, made.levels.size(), 1);
  const auto learned = draw_learned(made.graph, codes, dictionary, made.levels.size(), 1);
  CHECK(cv::norm(learned.mask, fitted.mask, cv::NORM_INF) == 0);
  CHECK(rms(learned.levels, fitted.levels, fitted.mask) < 2.5);  // contrasts are about 110
  // In colour: the same in each channel of a grey frame.
  cv::Mat colour;
  cv::merge(std::vector<cv::Mat>(3, made.levels), colour);
  const auto in_colour = draw_learned(made.graph, encode(colour, made.graph, dictionary, 0.3), dictionary,
                                      made.levels.size(), 3);
  cv::Mat first;
  cv::extractChannel(in_colour.levels, first, 0);
  CHECK(rms(first, learned.levels, fitted.mask) < 0.05);
}

TEST_CASE("Without codes patches are drawn from their attributes") {
  const DrawnFrame made = drawn();
  const std::vector<PatchCode> none(made.graph.size());
  const auto fitted = draw_fitted(made.graph, made.levels.size(), 1);
  const auto learned = draw_learned(made.graph, none, Dictionary{}, made.levels.size(), 1);
  CHECK(cv::norm(learned.mask, fitted.mask, cv::NORM_INF) == 0);
  CHECK(rms(learned.levels, fitted.levels, fitted.mask) < 1);
}

TEST_CASE("What cannot be coded or drawn is told") {
  const DrawnFrame made = drawn();
  const Dictionary dictionary = learned_from(made);
  const cv::Mat bytes(10, 10, CV_8U, cv::Scalar(0));
  CHECK_THROWS_AS(view_patches(bytes, made.graph), core::InputError);
  CHECK_THROWS_AS(encode(made.levels, made.graph, dictionary, 0), core::InputError);
  auto codes = encode(made.levels, made.graph, dictionary, 1);
  codes[3].entry = 4000;
  CHECK(test::message_of<std::runtime_error>([&] {
          draw_learned(made.graph, codes, dictionary, made.levels.size(), 1);
        }).find("patch 3 names entry 4000") != std::string::npos);
  codes.pop_back();
  CHECK_THROWS_AS(draw_learned(made.graph, codes, dictionary, made.levels.size(), 1), core::InputError);
}

TEST_CASE("A dictionary reads back from its archive bit for bit") {
  const Dictionary dictionary = learned_from(drawn(1));
  REQUIRE(std::ranges::any_of(dictionary.entries, &DictionaryEntry::window));
  REQUIRE(std::ranges::any_of(dictionary.entries,
                              [](const DictionaryEntry& e) { return !e.components.empty(); }));
  const auto archive = to_archive(dictionary);
  CHECK(sketch::read_dictionary(archive) == dictionary);
  CHECK(sketch::read_dictionary(to_archive(Dictionary{})).entries.empty());
}

TEST_CASE("Bad archives are refused in one line that names what is wrong") {
  const auto good = to_archive(learned_from(drawn(1)));
  const auto refused = [&](const std::function<void(core::ModelArchive&)>& spoil) {
    auto archive = good;
    spoil(archive);
    std::string message;
    try {
      sketch::read_dictionary(archive);
    } catch (const core::IoError& error) {
      message = error.what();
    }
    CHECK(message.starts_with("dictionary: "));
    CHECK(message.find('\n') == std::string::npos);
    return message;
  };
  const auto with = [](const std::function<void(nlohmann::json&)>& change) {
    return [change](core::ModelArchive& archive) {
      auto json = nlohmann::json::parse(archive.text);
      change(json);
      archive.text = json.dump();
    };
  };
  const auto says = [](const std::string& message, const std::string& part) {
    INFO(message);
    CHECK(message.find(part) != std::string::npos);
  };
  says(refused([](auto& a) { a.text = "{"; }), "JSON");
  says(refused([](auto& a) { a.text = "[]"; }), "no object");
  says(refused(with([](auto& j) { j["format"] = "emberfold.motion_model"; })), "emberfold.motion_model");
  says(refused(with([](auto& j) { j["version"] = 2; })), "newer than 1");
  says(refused(with([](auto& j) { j.erase("version"); })), "version");
  says(refused(with([](auto& j) { j["profile_samples"] = 31; })), "profile_samples");
  says(refused(with([](auto& j) { j["entries"][0]["type"] = "cloud"; })), "cloud");
  says(refused(with([](auto& j) { j["entries"][0]["degree"] = 5; })), "degree");
  says(refused(with([](auto& j) { j["entries"][0]["components"] = 9; })), "components");
  says(refused(with([](auto& j) { j["entries"].erase(0); })), "must be");
  says(refused([](auto& a) { a.arrays.erase("windows"); }), "windows.npy is missing");
  says(refused([](auto& a) { a.arrays["seen"].data = std::vector<float>(3); }), "int64");
  says(refused([](auto& a) { a.arrays["profiles"].shape = {1, 2, 3}; }), "1 x 2 x 3");
  says(refused([](auto& a) { std::get<std::vector<std::int64_t>>(a.arrays["seen"].data)[0] = 0; }), "seen");
  says(refused([](auto& a) {
         std::get<std::vector<float>>(a.arrays["profiles"].data)[0] = std::numeric_limits<float>::quiet_NaN();
       }),
       "mean");
  says(refused([](auto& a) {
         for (float& v : std::get<std::vector<float>>(a.arrays["windows"].data)) v *= 2;
       }),
       "RMS");
  says(refused([](auto& a) {
         std::get<std::vector<double>>(a.arrays["residuals"].data)[0] =
             std::numeric_limits<double>::infinity();
       }),
       "residual");
}
