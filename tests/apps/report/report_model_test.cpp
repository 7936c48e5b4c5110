// SPDX-License-Identifier: Apache-2.0
#include "apps/report/report_model.hpp"

#include <set>

#include <nlohmann/json.hpp>

#include "apps/builtin/open_clip.hpp"
#include "apps/commands/demo_story.hpp"
#include "apps/report/report.hpp"
#include "apps/report/report_strip.hpp"
#include "core/io/clip_reader.hpp"
#include "tests/apps/report/page_data.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/drawn_models.hpp"
#include "tests/support/drawn_motion.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::apps;
using namespace emberfold::test;

namespace {

const OrderedJson kModelSummary = {
    {"seed", 1}, {"options", OrderedJson::object()}, {"warnings", OrderedJson::array()}};

core::Clip plain_clip(cv::Size size, int frames, const std::function<cv::Mat(int)>& draw) {
  core::Clip clip;
  clip.info.width = size.width, clip.info.height = size.height, clip.info.channels = 3,
  clip.info.depth = CV_8U;
  for (int t = 0; t < frames; ++t) clip.frames.push_back(draw(t));
  return clip;
}

struct StripFixture {
  TempFolder temp;
  Console console;
  Session session{console, {}, "", {}};
  io::OutputFolder output{temp / "out"};
};

}  // namespace

TEST_CASE("the report shows the model's numbers, and what they mean") {
  const auto model = made_model(100, 70, 16);
  std::vector<graph::Event> events(5);
  events[1].type = events[2].type = graph::EventType::split;
  const OrderedJson shown = report_motion_model(model, events);

  CHECK_THAT(shown["sway"]["a1"].get<double>(), WithinRel(model.displacement.a1, 1e-3));
  CHECK_THAT(shown["sway"]["radius"].get<double>(),
             WithinRel(mcmc::spectral_radius(model.displacement), 1e-3));
  CHECK_THAT(shown["contrast"]["noise"].get<double>(), WithinRel(model.contrast.noise, 1e-3));
  REQUIRE(shown["poles"].size() == 4);
  for (const auto& pole : shown["poles"]) {
    const auto& of = pole["of"] == "sway" ? model.displacement : model.contrast;
    const std::complex<double> z(pole["re"].get<double>(), pole["im"].get<double>());
    CHECK(std::abs(z * z - of.a1 * z - of.a2) < 5e-3);
    CHECK(std::abs(z) < 1);
  }
  // cells that reach beyond the frame count with what lies in it
  double births = 0;
  for (int y = 0; y < 70; ++y)
    for (int x = 0; x < 100; ++x) {
      const int cell = y / 16 * 7 + x / 16;
      births += model.rates.birth.values[static_cast<std::size_t>(cell)];
    }
  std::map<std::string, OrderedJson> rates;
  for (const auto& row : shown["rates"]) rates[row["name"].get<std::string>()] = row;
  CHECK_THAT(rates["birth"]["rate"].get<double>(), WithinRel(births, 1e-3));
  CHECK(rates["birth"]["seen"] == 3);
  CHECK(rates["split"]["seen"] == 2);
  CHECK(rates["merge"]["seen"] == 0);
  CHECK_THAT(motion_model_figures(model)["rates"]["birth_per_frame"].get<double>(), WithinRel(births, 1e-3));
  CHECK(motion_model_figures(model)["exemplars"] == model.exemplars.size());

  CHECK(shown["birth"]["columns"] == 7);
  CHECK(shown["birth"]["values"].size() == 35);
  CHECK(shown["exemplars_total"] == model.exemplars.size());
  REQUIRE_FALSE(shown["exemplars"].empty());
  for (const auto& exemplar : shown["exemplars"]) {
    std::size_t points = 0;
    for (const auto& curve : exemplar["curves"]) points += (curve.size() - 1) / 2;
    CHECK(points >= exemplar["patches"].get<std::size_t>());
  }
}

TEST_CASE("maps of a large frame are pooled without changing their mean") {
  auto model = made_model(16 * 200, 16 * 120, 16);
  const OrderedJson shown = report_motion_model(model, {});
  const auto& values = shown["birth"]["values"];
  CHECK(values.size() <= 4000);
  CHECK(values.size() ==
        shown["birth"]["columns"].get<std::size_t>() * shown["birth"]["rows"].get<std::size_t>());
  double pooled = 0, whole = 0;
  for (const auto& value : values) pooled += value.get<double>() / double(values.size());
  for (const double value : model.rates.birth.values)
    whole += value / double(model.rates.birth.values.size());
  CHECK_THAT(pooled, WithinRel(whole, 0.02));
}

TEST_CASE("a page carries models and clips only where there are some, and no text of theirs becomes markup") {
  const auto motion = made_motion(made_strokes(2, 60, 60, 4), 60, 60, 4);
  ReportInput input;
  input.motion = &motion;
  input.clip = "a.avi";
  CHECK_FALSE(data_of(make_report(input, kModelSummary)).contains("learned"));
  CHECK_FALSE(data_of(make_report(input, kModelSummary)).contains("clips"));

  const std::string evil = "</script><script>alert(1)</script><!--";
  const auto model = made_model(60, 60, 16);
  input.model = &model;
  input.eigenvalues = {{0.5, 0.25}, {0.5, -0.25}, {-0.9, 0}};
  input.clips = ReportClips{{"Source", evil}, {1, 2, 3}, 60, 60, 4, 25};
  input.measures =
      ReportMeasures{{evil}, {{"psnr", evil, {1.23456, std::nullopt}}, {"nan", "", {NAN}}}, evil};
  const std::string page = make_report(input, kModelSummary);
  CHECK(page.find("<!--") == std::string::npos);
  CHECK(page.find("alert(1)<") == std::string::npos);
  const OrderedJson data = data_of(page);
  CHECK(data["clips"]["names"][1] == evil);
  CHECK(data["clips"]["mp4"] == "AQID");
  CHECK(data["measures"]["rows"][0]["values"] == OrderedJson({1.235, nullptr}));
  CHECK(data["measures"]["rows"][1]["values"] == OrderedJson::array({nullptr}));
  CHECK(data["learned"]["eigenvalues"][2] == OrderedJson({-0.9, 0.0}));
  CHECK_THAT(data["learned"]["texture_radius"].get<double>(), WithinAbs(0.9, 1e-12));
  CHECK(data["learned"]["motion"]["exemplars_total"] == model.exemplars.size());
}

TEST_CASE("the table of measures has each figure in its place, and a gap where there is none") {
  const OrderedJson measures = OrderedJson::parse(R"({
    "prediction": {"methods": {"frame_before": {"psnr": 30.5}, "mean_image": {"psnr": 20.04},
      "motion_model": {"psnr": 19.5}, "footage": {"psnr": 21.5}}},
    "reconstruction": {"motion_model": {"psnr": 25.25}},
    "synthesis": {"noise_floor": {"temporal_db": 0.5, "radial_db": 1.5},
      "motion_model": {"temporal_db": 2.5, "radial_db": 6.5}}})");
  const auto table = measures_table(measures);
  REQUIRE(table.columns.size() == 4);
  REQUIRE(table.rows.size() == 3);
  using Values = std::vector<std::optional<double>>;
  CHECK(table.rows[0].values == Values{21.5, 19.5, std::nullopt, 30.5});
  CHECK(table.rows[1].values == Values{std::nullopt, 2.5, std::nullopt, 0.5});
  CHECK(table.rows[2].values == Values{std::nullopt, 6.5, std::nullopt, 1.5});
  CHECK(contains(table.note, "20.0 dB"));
  CHECK(contains(table.note, "25.2"));
  for (const auto& row : measures_table(OrderedJson::object()).rows) CHECK(row.values == Values(4));
}

TEST_CASE("clips lie side by side in one video, frame by frame") {
  StripFixture made;
  const auto colour_clip = [](cv::Size size, int frames, int channel) {
    return plain_clip(size, frames, [=](int t) {
      cv::Scalar colour(20, 20, 20);
      colour[channel] = 60 + 15 * t;
      return cv::Mat(size, CV_8UC3, colour);
    });
  };
  const auto first = colour_clip({80, 61}, 12, 0), second = colour_clip({50, 90}, 9, 2);
  core::ClipSource a(first), b(second);
  (void)a.next();  // wherever they stand
  const std::vector<NamedSource> clips{{"one", &a}, {"two", &b}};
  const auto strip = make_strip(clips, made.output, made.session);
  CHECK(strip.names == std::vector<std::string>{"one", "two"});
  CHECK(strip.frames == 9);
  CHECK(strip.width == 80);
  CHECK(fs::is_empty(made.output.staged("x").parent_path()));
  const auto path = made.temp / "strip.mp4";
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(strip.mp4.data()), std::ssize(strip.mp4));
  const auto shown = core::read_all(*apps::open_clip(path.string(), {}, {}));
  REQUIRE(shown.frames.size() == 9);
  CHECK(shown.info.width == 2 * strip.width);
  for (int t = 0; t < 9; ++t) {
    const cv::Mat& frame = shown.frames[static_cast<std::size_t>(t)];
    const auto left = cv::mean(frame.colRange(4, 76)), right = cv::mean(frame.colRange(84, 156));
    CHECK_THAT(left[0], WithinAbs(60 + 15 * t, 5));
    CHECK_THAT(right[2], WithinAbs(60 + 15 * t, 5));
    CHECK(left[2] < 40);
    CHECK(right[0] < 40);
  }
}

TEST_CASE("clips of pure noise are made to fit the page") {
  StripFixture made;
  const auto noise = plain_clip({320, 240}, 60, [](int t) {
    return noise_frame({320, 240}, CV_8UC3, 1 + t);
  });
  core::ClipSource a(noise), b(noise), c(noise);
  const std::vector<NamedSource> clips{{"one", &a}, {"two", &b}, {"three", &c}};
  const auto strip = make_strip(clips, made.output, made.session);
  CHECK(strip.mp4.size() <= kClipBytes);
  CHECK(strip.mp4.size() > kClipBytes / 8);
  CHECK(strip.frames >= 15);
}
