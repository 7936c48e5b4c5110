// SPDX-License-Identifier: Apache-2.0
#include "dytex/model/archive.hpp"

#include <functional>
#include <limits>
#include <sstream>

#include "core/error.hpp"
#include "dytex/learn.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/matrices.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;

namespace {

dytex::LinearDynamicTexture learned(int channels, int depth) {
  const core::Clip clip = test::wavy_clip(9, 7, channels, depth, 20);
  core::ClipSource source(clip);
  return dytex::learn(source, {.components = 4, .energy = {}}).texture;
}

void replace(core::ModelArchive& archive, const std::string& from, const std::string& to) {
  const std::size_t at = archive.text.find(from);
  REQUIRE(at != std::string::npos);
  archive.text.replace(at, from.size(), to);
}

template <class Scalar>
std::vector<Scalar>& data(core::ModelArchive& archive, const char* name) {
  return std::get<std::vector<Scalar>>(archive.arrays.at(name).data);
}

}  // namespace

TEST_CASE("A texture comes back from its archive bit for bit", "[dytex][archive]") {
  for (const int depth : {CV_8U, CV_16U, CV_32F}) {
    for (const int channels : {1, 3}) {
      dytex::LinearDynamicTexture texture = learned(channels, depth);
      texture.info.fps = 30000 / 1001.0;
      core::ModelArchive archive = dytex::to_archive(texture);
      for (auto& [name, array] : archive.arrays) {  // as through a file
        std::stringstream file;
        core::write_npy(file, array);
        array = core::read_npy(file);
      }
      CHECK(test::same(dytex::linear_dynamic_texture(archive), texture));
    }
  }
}

TEST_CASE("A texture without components comes back too", "[dytex][archive]") {
  const core::Clip clip = test::clip_of(Eigen::MatrixXd::Constant(12, 5, 77), 4, 3, 1, CV_8U);
  core::ClipSource source(clip);
  const dytex::LinearDynamicTexture texture = dytex::learn(source, {.components = 2, .energy = {}}).texture;
  CHECK(test::same(dytex::linear_dynamic_texture(dytex::to_archive(texture)), texture));
}

TEST_CASE("All that a texture may have comes back from its archive", "[dytex][archive]") {
  dytex::LinearDynamicTexture texture = learned(3, CV_8U);
  texture.weights << 1, 0.5, -2, 0;
  texture.noise = Eigen::VectorXf::LinSpaced(texture.pixels(), 0, 9);
  Eigen::MatrixXd longer = Eigen::MatrixXd::Zero(8, 8);  // a state of twice as many numbers
  longer.topLeftCorner(4, 4) = texture.A;
  longer.bottomLeftCorner(4, 4).setIdentity();
  texture.A = longer;
  texture.B.conservativeResizeLike(Eigen::MatrixXd::Zero(8, texture.B.cols()));
  texture.states.conservativeResizeLike(Eigen::MatrixXd::Zero(8, 20));
  const core::ModelArchive archive = dytex::to_archive(texture);
  CHECK(test::same(dytex::linear_dynamic_texture(archive), texture));
  const core::ModelView view = dytex::archive_view(texture);
  CHECK(view.text == archive.text);
  CHECK(std::get<std::span<const float>>(view.arrays.at("C").data).data() == texture.C.data());  // no copy
}

TEST_CASE("An archive of version 1 is read, with weights of 1", "[dytex][archive]") {
  const dytex::LinearDynamicTexture texture = learned(1, CV_8U);
  core::ModelArchive archive = dytex::to_archive(texture);
  archive.text =
      R"({"format": "emberfold.linear_dynamic_texture", "version": 1, "width": 9, "height": 7, "channels": 1,
          "fps": 25.0, "frames": 20, "depth": "u8", "white": 255.0, "components": 4, "noise_inputs": 4, "r": )" +
      archive.text.substr(
          archive.text.find("\"r\": ") + 5,
          archive.text.find(",", archive.text.find("\"r\": ")) - archive.text.find("\"r\": ") - 5) +
      "}";
  archive.arrays.erase("weights");
  CHECK(test::same(dytex::linear_dynamic_texture(archive), texture));
}

TEST_CASE("Arrays may lie in rows", "[dytex][archive]") {
  const dytex::LinearDynamicTexture texture = learned(1, CV_8U);
  core::ModelArchive archive = dytex::to_archive(texture);
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows = texture.A;
  archive.arrays["A"] = {{4, 4}, false, std::vector<double>(rows.data(), rows.data() + 16)};
  CHECK(test::same(dytex::linear_dynamic_texture(archive), texture));
}

TEST_CASE("A broken archive is refused with its reason", "[dytex][archive]") {
  struct Damage {
    const char* message;
    std::function<void(core::ModelArchive&)> make;
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Damage> table{
      {"model: model.json is no valid JSON", [](auto& a) { a.text.clear(); }},
      {"model: model.json is no valid JSON", [](auto& a) { a.text.resize(a.text.size() / 2); }},
      {"model: model.json holds no object", [](auto& a) { a.text = "[1]"; }},
      {"model: model.json is nested more than 16 deep", [](auto& a) { a.text = std::string(100000, '['); }},
      {"model: \"format\" is \"emberfold.motion_model\", must be \"emberfold.linear_dynamic_texture\"",
       [](auto& a) { replace(a, "emberfold.linear_dynamic_texture", "emberfold.motion_model"); }},
      {"model: \"format\" must be a text", [](auto& a) { a.text = R"({"format":1})"; }},
      {"model: version 4 is newer than 2, the newest that can be read",
       [](auto& a) { replace(a, "\"version\": 2", "\"version\": 4"); }},
      {"model: the array weights is missing", [](auto& a) { a.arrays.erase("weights"); }},
      {"model: the array noise is missing",
       [](auto& a) { replace(a, "\"noise_per_value\": false", "\"noise_per_value\": true"); }},
      {"model: \"noise_per_value\" must be true or false",
       [](auto& a) { replace(a, "\"noise_per_value\": false", "\"noise_per_value\": 1"); }},
      {"model: texture: A is 3 × 3 for 4 components, must be at least 4 × 4",
       [](auto& a) {
         replace(a, "\"order\": 4", "\"order\": 3");
         replace(a, "\"noise_inputs\": 4", "\"noise_inputs\": 3");
         a.arrays["A"] = {{3, 3}, true, std::vector<double>(9)};
         a.arrays["B"] = {{3, 3}, true, std::vector<double>(9)};
         a.arrays["states"] = {{3, 20}, true, std::vector<double>(60)};
       }},
      {"model: model.json has no \"width\"", [](auto& a) { replace(a, "\"width\"", "\"breadth\""); }},
      {"model: \"width\" is \"65537\", must be a whole number from 1 to 65536",
       [](auto& a) { replace(a, "\"width\": 9", "\"width\": 65537"); }},
      {"model: \"height\" is \"0\", must be a whole number from 1 to 65536",
       [](auto& a) { replace(a, "\"height\": 7", "\"height\": 0"); }},
      {"model: \"height\" is \"18446744073709551615\", must be a whole number from 1 to 65536",
       [](auto& a) { replace(a, "\"height\": 7", "\"height\": 18446744073709551615"); }},
      {"model: \"height\" is \"7.5\", must be a whole number from 1 to 65536",
       [](auto& a) { replace(a, "\"height\": 7", "\"height\": 7.5"); }},
      {"model: texture: channels is 2; allowed is 1 or 3",
       [](auto& a) {
         replace(a, "\"channels\": 1", "\"channels\": 2");
         replace(a, "\"width\": 9", "\"width\": 9");
         a.arrays["mean"] = {{126}, false, std::vector<float>(126)};
         a.arrays["C"] = {{126, 4}, true, std::vector<float>(126 * 4)};
       }},
      {"model: \"depth\" is \"u32\", must be \"u8\", \"u16\" or \"f32\"",
       [](auto& a) { replace(a, "u8", "u32"); }},
      {"model: \"fps\" is \"null\", must be a finite number",
       [](auto& a) { replace(a, "\"fps\": 25.0", "\"fps\": null"); }},
      {"model: texture: fps is -1.000000, must be positive and finite",
       [](auto& a) { replace(a, "\"fps\": 25.0", "\"fps\": -1"); }},
      {"model: the array C has the shape (63, 4), must have (63, 5)",
       [](auto& a) { replace(a, "\"components\": 4", "\"components\": 5"); }},
      {"model: the array C has the shape (63, 4), must have (63, 16777216)",
       [](auto& a) { replace(a, "\"components\": 4", "\"components\": 16777216"); }},
      {"model: the array mean is missing", [](auto& a) { a.arrays.erase("mean"); }},
      {"model: the array states is missing", [](auto& a) { a.arrays.erase("states"); }},
      {"model: the array C must hold float32, float16 or uint8",
       [](auto& a) { a.arrays["C"].data = std::vector<double>(63 * 4); }},
      {"model: the array A must hold float64", [](auto& a) { a.arrays["A"].data = std::vector<float>(16); }},
      {"model: the array A has the shape (16,), must have (4, 4)",
       [](auto& a) { a.arrays["A"].shape = {16}; }},
      {"model: the array C has the shape (4, 63), must have (63, 4)",
       [](auto& a) {
         a.arrays["C"].shape = {4, 63};
       }},
      {"model: the array A has 15 numbers, its shape (4, 4) another number",
       [](auto& a) { data<double>(a, "A").pop_back(); }},
      {"model: texture: C has a value that is not finite",
       [](auto& a) { data<float>(a, "C")[17] = std::numeric_limits<float>::infinity(); }},
      {"model: texture: mean has a value that is not finite",
       [](auto& a) { data<float>(a, "mean")[0] = std::numeric_limits<float>::quiet_NaN(); }},
      {"model: texture: A has a value that is not finite", [=](auto& a) { data<double>(a, "A")[3] = kNan; }},
      {"model: texture: B has a value that is not finite", [=](auto& a) { data<double>(a, "B")[0] = kNan; }},
      {"model: texture: states has a value that is not finite",
       [=](auto& a) { data<double>(a, "states")[5] = kNan; }},
      {"model: texture: singular has a negative value", [](auto& a) { data<double>(a, "singular")[5] = -1; }},
      {"model: texture: A has the spectral radius 2.000000, must be below 1",
       [](auto& a) {
         auto& A = data<double>(a, "A");
         std::fill(A.begin(), A.end(), 0);
         A[5] = -2;
       }},
  };
  const core::ModelArchive whole = dytex::to_archive(learned(1, CV_8U));
  for (const Damage& damage : table) {
    core::ModelArchive archive = whole;
    damage.make(archive);
    CHECK(test::message_of<core::IoError>([&] { dytex::linear_dynamic_texture(archive); }) == damage.message);
  }
}

TEST_CASE("A texture that is not valid is not kept", "[dytex][archive]") {
  const dytex::LinearDynamicTexture texture = learned(1, CV_8U);
  const auto complaint = [](const dytex::LinearDynamicTexture& bad) {
    return test::message_of<core::InputError>([&] { dytex::to_archive(bad); });
  };
  dytex::LinearDynamicTexture bad = texture;
  bad.r = -1;
  CHECK(complaint(bad) == "texture: r is -1.000000, must be finite and at least 0");
  bad = texture;
  bad.B = Eigen::MatrixXd::Zero(4, 5);
  CHECK(complaint(bad) == "texture: B is 4 × 5, must have at most 4 columns");
  bad = texture;
  bad.states.conservativeResize(4, 19);
  CHECK(complaint(bad) == "texture: states is 4 × 19, must be 4 × 20");
  bad = texture;
  bad.weights.conservativeResize(3);
  CHECK(complaint(bad) == "texture: weights is 3 × 1, must be 4 × 1");
  bad = texture;
  bad.noise = Eigen::VectorXf::Constant(63, -1);
  CHECK(complaint(bad) == "texture: noise has a negative value");
  bad.noise = Eigen::VectorXf::Ones(62);
  CHECK(complaint(bad) == "texture: noise is 62 × 1, must be 63 × 1");
  bad = texture;
  bad.A = Eigen::MatrixXd::Identity(4, 4);
  CHECK(complaint(bad) == "texture: A has the spectral radius 1.000000, must be below 1");
}
