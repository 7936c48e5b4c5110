// SPDX-License-Identifier: Apache-2.0
// distance and compress.
#include <algorithm>
#include <fstream>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "apps/textures/texture_distances.hpp"
#include "apps/textures/texture_folder.hpp"
#include "core/error.hpp"
#include "core/io/clip_reader.hpp"
#include "dytex/model/compression.hpp"
#include "tests/apps/commands/waves_clip.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::apps;
using namespace emberfold::test;

TEST_CASE("dytex distance tells all distances of two models") {
  const TempFolder temp;
  const auto a = learn_texture(write_waves(temp / "a", {0.3, 0.95}, 1), temp / "slow");
  const auto b = learn_texture(write_waves(temp / "b", {1.5, 0.95}, 2), temp / "quick");
  const auto told = run_command({"dytex", "distance", a, b});
  INFO(told.err);
  REQUIRE(told.exit == 0);
  for (const char* part : {"slow (1) and quick (2)", "1 from 2", "KL rate", "Martin", "degrees", "windows'"})
    CHECK(contains(told.out, part));
  const auto p = read_texture(a), q = read_texture(b);
  const auto result = run_command({"dytex", "distance", a, b, "--json", "-q"});
  REQUIRE(result.exit == 0);
  const Json json = Json::parse(result.out);
  CHECK(json["models"] == Json({a, b}));
  const Json& measures = json["measures"];
  CHECK_THAT(measures["kl"][0][1].get<double>(), WithinRel(dytex::kl_rate(p, q), 1e-9));
  CHECK_THAT(measures["kl"][1][0].get<double>(), WithinRel(dytex::kl_rate(q, p), 1e-9));
  CHECK(measures["kl"][0][0] == 0);
  const auto angles = dytex::subspace_angles(p, q);
  CHECK_THAT(measures["martin"][0][1].get<double>(), WithinRel(dytex::martin_distance(angles), 1e-9));
  CHECK_THAT(measures["angles"][1][0].get<double>(), WithinRel(angles.norm(), 1e-9));
  CHECK(json["angles"].size() == 8);
}

TEST_CASE("dytex distance writes matrix and growth, the same at any number of threads") {
  const TempFolder temp;
  std::vector<std::string> models;
  for (int i = 0; i < 3; ++i)
    models.push_back(learn_texture(write_waves(temp / ("clip" + std::to_string(i)), {i < 2 ? 0.3 : 1.5, 0.95},
                                               static_cast<std::uint64_t>(i) + 1),
                                   temp / ("m" + std::to_string(i))));
  for (const std::string threads : {"1", "2", "8"}) {
    const auto out = run_command(joined({"dytex", "distance"}, models,
                                        {"-o", (temp / ("out" + threads)).string(), "--growth", "40",
                                         "--measure", "kl", "--threads", threads}));
    INFO(out.err);
    REQUIRE(out.exit == 0);
    CHECK(contains(out.out, "KL rate of the row's model from the column's"));
    for (const char* name : {"matrix.json", "matrix.csv", "matrix.png", "growth.json", "growth.png"})
      CHECK(bytes_of(temp / ("out" + threads) / name) == bytes_of(temp / "out1" / name));
  }
  const Json matrix = Json::parse(bytes_of(temp / "out1" / "matrix.json"));
  CHECK(matrix["format"] == "emberfold.texture_distances");
  for (const char* measure : {"kl", "martin", "angles", "windows"}) {
    const Json& rows = matrix["measures"][measure];
    REQUIRE(rows.size() == 3);
    CHECK(rows[0][1] < rows[0][2]);  // the same dynamics are nearer
    CHECK(rows[1][0] < rows[1][2]);
  }
  const auto csv = bytes_of(temp / "out1" / "matrix.csv");
  CHECK(csv.starts_with("model,m0,m1,m2\nm0,0"));
  CHECK(std::ranges::count(csv, '\n') == 4);
  const Json growth = Json::parse(bytes_of(temp / "out1" / "growth.json"));
  REQUIRE(growth["curves"].size() == 2);  // of the first from the others
  for (const auto& curve : growth["curves"]) {
    const auto values = curve["divergence"].get<std::vector<double>>();
    REQUIRE(values.size() == 40);
    CHECK(std::ranges::is_sorted(values));
    CHECK_THAT(values[39] - values[38], WithinRel(curve["rate"].get<double>(), 0.3));
  }
  for (const char* name : {"matrix.png", "growth.png"})
    CHECK(cv::imread((temp / "out1" / name).string()).cols > 100);
}

TEST_CASE("What dytex distance cannot compare is refused in one line") {
  const TempFolder temp;
  const auto a = learn_texture(write_waves(temp / "a", {}, 1), temp / "ma");
  const auto wide = learn_texture(write_waves(temp / "b", {}, 2, {26, 20}), temp / "mb");
  const auto out = (temp / "out").string();
  const auto refused = [&](const std::vector<std::string>& more, int exit,
                           const std::vector<std::string>& what) {
    check_one_line(joined({"dytex", "distance"}, more, {"-q"}), exit, what, out);
  };
  refused({a}, 2, {"one model has no distance"});
  refused({a, a, "--measure", "cosine"}, 2, {"--measure is cosine", "kl, martin, angles, windows"});
  refused({a, a, "--growth", "5"}, 2, {"--growth", "--output"});
  refused({a, a, "--growth", "0", "-o", out}, 2, {"--growth is 0", "1 to 100000"});
  refused({a, wide}, 1, {wide + " has frames of 26 x 20 in grey", "24 x 20 in grey"});
  refused({a, (temp / "a").string()}, 1, {"is a clip, not a model"});
  refused({a, (temp / "none").string(), "-o", out}, 1, {"none", "no such"});
  // A model of as many components as there can be has no noise r.
  const auto exact = learn_texture(write_waves(temp / "c", {}, 3, {24, 20}, 8), temp / "mc", "7");
  REQUIRE(read_texture(exact).r == 0);
  refused({a, exact, "--measure", "kl"}, 1, {exact, "noise r is 0", "fewer components"});
  const auto told = run_command({"dytex", "distance", a, exact});
  CHECK(told.exit == 0);
  CHECK(contains(told.err, "noise r is 0"));
  CHECK(contains(told.out, "-"));
  CHECK(Json::parse(run_command({"dytex", "distance", a, exact, "--json"}).out)["measures"]["kl"][0][1]
            .is_null());
}

TEST_CASE("Names of models are as long as needed to tell them apart") {
  CHECK(short_names({"out/a", "out/b/"}) == std::vector<std::string>{"a", "b"});
  CHECK(short_names({"x/m", "y/m"}) == std::vector<std::string>{"x/m", "y/m"});
  CHECK(short_names({"m", "m"}) == std::vector<std::string>{"m", "m"});
}

TEST_CASE("dytex compress keeps a model in fewer bytes that every command reads") {
  const TempFolder temp;
  const auto clip = write_waves(temp / "clip", {}, 1, {64, 48}, 40);
  const auto model = learn_texture(clip, temp / "model");
  double before = 1000;
  std::uintmax_t larger = fs::file_size(fs::path(model) / "C.npy");
  const auto texture = read_texture(model);
  for (const std::string precision : {"f16", "u8"}) {
    const auto small = (temp / precision).string();
    const auto result =
        run_command({"dytex", "compress", model, clip, "-o", small, "--precision", precision, "--json"});
    INFO(result.err);
    REQUIRE(result.exit == 0);
    CHECK(5 * fs::file_size(fs::path(small) / "C.npy") < 3 * larger);
    larger = fs::file_size(fs::path(small) / "C.npy");
    const Json json = Json::parse(result.out)["compression"];
    CHECK(json["clip_bytes"] == 64 * 48 * 40);
    std::uintmax_t images = 0;
    for (const auto& file : fs::directory_iterator(clip)) images += file.file_size();
    CHECK(json["file_bytes"] == images);
    std::uintmax_t arrays = 0;
    for (const auto& file : fs::directory_iterator(small))
      if (file.path().extension() == ".npy") arrays += file.file_size() - 128;
    bool found = false;
    for (const auto& kept : json["kept"]) {
      if (kept["precision"] != precision || kept["components"] != 8) continue;
      found = true;
      CHECK(kept["bytes"] == arrays);
      CHECK_THAT(kept["psnr"].get<double>(), WithinAbs(kept["psnr_measured"].get<double>(), 0.5));
      CHECK(kept["psnr"] < before);
      before = kept["psnr"];
    }
    CHECK(found);
    CHECK(cv::imread(small + "/compression.png").cols == 900);
    // The rest is the same, and the commands take it.
    CHECK((read_texture(small).A - texture.A).norm() == 0);
    CHECK(run_command(
              {"dytex", "synth", small, "-o", (temp / ("s" + precision)).string(), "--frames", "3", "-q"})
              .exit == 0);
    CHECK(run_command({"dytex", "info", small}).exit == 0);
    const Json apart = Json::parse(run_command({"dytex", "distance", model, small, "--json", "-q"}).out);
    CHECK(apart["measures"]["martin"][0][1] < 0.2);
    CHECK(run_command({"dytex", "compress", small, "-o", (temp / "again").string(), "-q"}).exit == 0);
  }
  const auto told = run_command({"dytex", "compress", model});
  CHECK(told.exit == 0);
  for (const char* part : {"f32", "f16", "u8", "PSNR", "bytes"}) CHECK(contains(told.out, part));
  CHECK_FALSE(contains(told.out, "measured"));
}

TEST_CASE("What dytex compress cannot do is refused in one line") {
  const TempFolder temp;
  const auto clip = write_waves(temp / "clip", {}, 1);
  const auto model = learn_texture(clip, temp / "model"), out = (temp / "out").string();
  const auto refused = [&](const std::vector<std::string>& more, int exit,
                           const std::vector<std::string>& what) {
    check_one_line(joined({"dytex", "compress"}, more, {"-q"}), exit, what, out);
  };
  refused({model, "-o", out, "--precision", "f64"}, 2, {"--precision is f64", "f32, f16 or u8"});
  refused({model, "-o", model}, 2, {"--output is the model itself"});
  refused({clip, "-o", out}, 1, {"is a clip, not a model"});
  refused({model, clip, "--range", "0:50", "-o", out}, 1, {"50 frames", "learned from 60"});
  refused({model, clip, "--scale", "0.5", "-o", out}, 1, {"12×10 in grey", "24×20 in grey"});
  refused({model, (temp / "none.avi").string(), "-o", out}, 1, {"none.avi"});
}

TEST_CASE("help of distance and classify and compress opens with examples") {
  for (const std::string command : {"distance", "classify", "compress"}) check_help(command);
}
