// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <bit>
#include <regex>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <zlib.h>

#include "apps/page/packed_text.hpp"
#include "apps/page/page_title.hpp"
#include "apps/page/texture_page.hpp"
#include "core/error.hpp"
#include "dytex/editing/edit.hpp"
#include "dytex/model/layers.hpp"
#include "tests/apps/commands/command_check.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::apps;
using namespace emberfold::test;

namespace {

using Bytes = std::vector<unsigned char>;

Bytes from_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  Bytes bytes;
  unsigned bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = (bits << 6 | static_cast<unsigned>(digits.find(c))) & 0xFFFFFF;
    count += 6;
    if (count >= 8) bytes.push_back(static_cast<unsigned char>(bits >> (count -= 8)));
  }
  return bytes;
}

Bytes inflated(const std::string& text, std::size_t size) {
  const Bytes packed = from_base64(text);
  Bytes bytes(size + 1);
  uLongf length = bytes.size();
  REQUIRE(uncompress(bytes.data(), &length, packed.data(), packed.size()) == Z_OK);
  REQUIRE(length == size);
  return bytes;
}

int wrapped(int value) {
  return static_cast<std::int16_t>(value);
}

// The other way round than apps/page/packed_text.cpp, as its header tells it.
std::vector<int> unpacked_image(const std::string& text, int width, int height, int channels) {
  const auto area = static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
             all = area * static_cast<std::size_t>(channels);
  const Bytes bytes = inflated(text, 2 * all);
  std::vector<int> planes(all);
  for (std::size_t at = 0; at < all; ++at) {
    const std::size_t p = at % area, w = static_cast<std::size_t>(width);
    const int left = p % w == 0 ? 0 : planes[at - 1], upper = p < w ? 0 : planes[at - w];
    const int corner = p < w || p % w == 0 ? 0 : planes[at - w - 1];
    std::array three{left, upper, wrapped(left + upper - corner)};
    std::ranges::sort(three);
    const int code = bytes[at] + 256 * bytes[all + at];
    planes[at] = wrapped(three[1] + (code % 2 == 1 ? -(code + 1) / 2 : code / 2));
  }
  std::vector<int> values(all);
  for (std::size_t p = 0; p < area; ++p) {
    if (channels == 1) {
      values[p] = planes[p];
      continue;
    }
    const int middle = wrapped(planes[p] - (planes[2 * area + p] >> 1));
    const int blue = wrapped(middle - (planes[area + p] >> 1));
    values[3 * p] = blue;
    values[3 * p + 1] = wrapped(planes[2 * area + p] + middle);
    values[3 * p + 2] = wrapped(blue + planes[area + p]);
  }
  return values;
}

/// The texts of the page's script elements that open like this.
std::vector<std::string> elements(const std::string& page, const std::string& open) {
  std::vector<std::string> texts;
  for (auto at = page.find(open); at != std::string::npos; at = page.find(open, at + 1)) {
    const auto begin = at + open.size();
    texts.push_back(page.substr(begin, page.find("</script>", begin) - begin));
  }
  return texts;
}

/// Waves of many lengths; state i has the variance 1/(1 − 0.81) times its own.
dytex::LinearDynamicTexture waves(int width, int height, int channels, int n, double amplitude) {
  dytex::LinearDynamicTexture texture;
  texture.info.width = width, texture.info.height = height, texture.info.channels = channels;
  texture.info.depth = CV_8U;
  texture.info.frames = 12;
  const Eigen::Index m = Eigen::Index{width} * height * channels;
  texture.mean = Eigen::VectorXf::LinSpaced(m, 20, 230);
  texture.C.resize(m, n);
  for (int i = 0; i < n; ++i)
    for (Eigen::Index p = 0; p < m; ++p)
      texture.C(p, i) = std::sin(0.002F * static_cast<float>((i + 1) * (p + 7)));
  for (int i = 0; i < n; ++i) texture.C.col(i).normalize();
  texture.A = 0.9 * Eigen::MatrixXd::Identity(n, n);
  texture.B = Eigen::VectorXd::LinSpaced(n, amplitude, amplitude / 5).asDiagonal();
  texture.weights = Eigen::VectorXd::Ones(n);
  core::Rng rng(3);
  texture.states.resize(n, 12);
  for (double& x : texture.states.reshaped()) x = amplitude * rng.normal();
  texture.singular = Eigen::VectorXd::Ones(12);
  return texture;
}

TexturePage page_of(const dytex::LinearDynamicTexture& texture, const std::string& name = "out/sea") {
  return make_texture_page({&texture, name, {}, "1.2.3"});
}

}  // namespace

TEST_CASE("images packed as text come back whole") {
  core::Rng rng(11);
  for (const int channels : {1, 3})
    for (const std::uint32_t range : {3U, 300U, 65536U}) {
      std::vector<std::int16_t> values(static_cast<std::size_t>(13 * 7 * channels));
      for (auto& v : values) v = static_cast<std::int16_t>(rng.below(range) - range / 2);
      const auto back = unpacked_image(packed_image(values, {13, 7}), 13, 7, channels);
      CHECK(std::ranges::equal(back, values));
    }
  const std::vector<double> numbers{0, -1.5, 1e300, 5e-324, 0.1};
  const Bytes bytes = inflated(packed_numbers(numbers), 40);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    std::uint64_t bits = 0;
    for (std::size_t b = 0; b < 8; ++b) bits |= std::uint64_t{bytes[8 * i + b]} << (8 * b);
    CHECK(std::bit_cast<double>(bits) == numbers[i]);
  }
}

TEST_CASE("a page is one file that asks for nothing else and carries the model") {
  const auto texture = waves(40, 30, 3, 7, 400);
  const auto page = page_of(texture);
  const std::string& html = page.html;
  CHECK_FALSE(std::regex_search(html, std::regex("(src|href|action|poster)\\s*=\\s*[\"']?(https?:)?//")));
  CHECK_FALSE(std::regex_search(
      html, std::regex("@import|url\\(|fetch\\(|XMLHttpRequest|import\\(|WebSocket|https?://")));
  CHECK(contains(html, "default-src 'none'"));
  CHECK(html.find("{{") == std::string::npos);
  CHECK(count(html, "<script") == 3 + 1 + 7);  // data, numbers, the program; mean and components
  CHECK(count(html, "</script>") == count(html, "<script"));

  const auto data =
      nlohmann::json::parse(elements(html, "<script type=\"application/json\" id=\"data\">").at(0));
  CHECK(data["width"] == 40);
  CHECK(data["components"] == 7);
  CHECK(data["presets"].size() == dytex::presets().size());
  CHECK(data["title"] == "sea");
  const auto images = elements(html, "<script type=\"text/plain\" class=\"image\">");
  REQUIRE(images.size() == 8);
  double squares = 0;
  Eigen::MatrixXd wrong = Eigen::MatrixXd::Zero(texture.pixels(), texture.states.cols());
  for (std::size_t i = 0; i < images.size(); ++i) {
    const double step = i == 0 ? data["mean_step"].get<double>() : data["steps"][i - 1].get<double>();
    const auto whole = unpacked_image(images[i], 40, 30, 3);
    const Eigen::VectorXd shown = step * Eigen::Map<const Eigen::VectorXi>(whole.data(), 3600).cast<double>();
    const bool wide = std::ranges::any_of(whole, [](int v) { return std::abs(v) > 127; });
    CHECK(data["wide"][i] == wide);
    if (i == 0)
      wrong.colwise() += shown - texture.mean.cast<double>();
    else
      wrong += (shown - texture.C.col(static_cast<Eigen::Index>(i) - 1).cast<double>()) *
               texture.states.row(static_cast<Eigen::Index>(i) - 1);
  }
  squares = wrong.squaredNorm() / static_cast<double>(wrong.size());
  CHECK(std::sqrt(squares) < 0.25);
  CHECK(wrong.cwiseAbs().maxCoeff() < 1.5);
  CHECK(page.error < 0.25);
  CHECK(page.largest_error < 1.5);
}

TEST_CASE("a page of usual size stays below 12 MB") {
  const auto page = page_of(waves(352, 288, 3, 50, 3000));
  CHECK(page.html.size() < 12'000'000);
  CHECK(page.largest_error < 1.5);
}

TEST_CASE("no name of a model becomes markup in its page") {
  const std::string evil = "a</script><script>alert(1)</script><!--&quot;\"'{{script}}\xff\xc3\x28";
  const auto texture = waves(8, 6, 1, 2, 50);
  const auto page = make_texture_page({&texture, evil, {evil}, "1"});
  CHECK(count(page.html, "<script") == 3 + 1 + 2);
  CHECK(count(page.html, "</script>") == count(page.html, "<script"));
  CHECK(count(page.html, "<!--") == 0);
  CHECK(contains(page.html, "<h1>script&gt;&lt;!--&amp;quot;"));  // a path's last part is the title
}

TEST_CASE("pages of odd models") {
  auto still = waves(8, 6, 1, 2, 50);
  still.C.resize(48, 0), still.A.resize(0, 0), still.B.resize(0, 0), still.states.resize(0, 12);
  still.weights.resize(0);
  still.r = 4;
  CHECK(count(page_of(still).html, "class=\"image\"") == 1);
  CHECK(page_of(still).largest_error <= 0.0625 + 1e-6);

  auto silent = waves(8, 6, 1, 2, 50);  // nothing moves, and one component is 0
  silent.B.setZero(), silent.states.setZero(), silent.C.col(1).setZero();
  CHECK(page_of(silent).largest_error <= 0.0625 + 1e-6);

  auto loud = waves(8, 6, 1, 2, 1e9);  // beyond what two bytes hold at the usual step
  CHECK_NOTHROW(page_of(loud));

  auto deep = waves(8, 6, 1, 1, 50);
  deep.A = Eigen::MatrixXd::Zero(401, 401), deep.B = Eigen::MatrixXd::Ones(401, 1);
  deep.states = Eigen::MatrixXd::Zero(401, 12);
  const auto message = message_of<core::InputError>([&] { page_of(deep); });
  CHECK(contains(message, "401 numbers"));
  CHECK(contains(message, "400"));
}

TEST_CASE("a page shows no path from outside the folder it was made in") {
  CHECK(shown_path("out/sea") == "out/sea");
  CHECK(shown_path("out/sea/") == "out/sea");
  CHECK(shown_path("/home/someone/secret/sea") == "sea");
  CHECK(shown_path("../secret/sea/") == "sea");
  CHECK(shown_path("/home/someone/fire/model") == "fire/model");
  CHECK(shown_path("out/../../secret/sea") == "sea");
  CHECK(page_of(waves(40, 30, 3, 7, 400), "/home/someone/sea").html.find("someone") == std::string::npos);
}

TEST_CASE("dytex page writes its file whole or tells in a line why not") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {24, 20}, 6);
  const auto model = (temp / "model").string(), page = (temp / "page.html").string();
  REQUIRE(run_command({"dytex", "learn", clip, "-o", model, "-n", "3", "-q"}).exit == 0);
  const auto made = run_command({"dytex", "page", model, "-o", page, "--json", "-q"});
  REQUIRE(made.exit == 0);
  const auto summary = nlohmann::json::parse(made.out);
  CHECK(summary["bytes"] == fs::file_size(page));
  CHECK(summary["error"]["largest"].get<double>() < 1.5);
  const auto first = bytes_of(page);
  REQUIRE(run_command({"dytex", "page", model, "-o", page, "--threads", "1", "-q", "--overwrite"}).exit == 0);
  CHECK(bytes_of(page) == first);
  CHECK_FALSE(fs::exists(page + ".part"));

  check_one_line({"dytex", "page", model, "-o", model, "-q"}, 2, {model, "which is read"});
  const auto nowhere = temp / "no" / "page.html";
  check_one_line({"dytex", "page", model, "-o", nowhere.string(), "-q"}, 1, {nowhere.string()}, nowhere);
  const auto other = temp / "other.html";
  check_one_line({"dytex", "page", clip, "-o", other.string(), "-q"}, 1, {"is a clip, not a model"}, other);
  check_one_line({"dytex", "page", model, "-q"}, 2, {"--output"});
  CHECK_FALSE(fs::exists(other.string() + ".part"));
}
