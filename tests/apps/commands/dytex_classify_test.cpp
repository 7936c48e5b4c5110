// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "apps/textures/classification.hpp"
#include "core/error.hpp"
#include "core/rng.hpp"
#include "tests/apps/commands/waves_clip.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::apps;
using namespace emberfold::test;

namespace {

/// The samples' distances as two groups would have them: near within, far across.
std::vector<dytex::Distances> grouped(const std::vector<std::size_t>& group) {
  std::vector<dytex::Distances> pairs;
  core::Rng rng(1);
  for (std::size_t i = 0; i < group.size(); ++i)
    for (std::size_t j = i; j < group.size(); ++j) {
      const double d = i == j ? 0 : (group[i] == group[j] ? 0.1 : 1) * rng.uniform(0.9, 1);
      dytex::Distances pair;
      pair.kl = pair.kl_back = 10 * d;
      pair.angles = Eigen::Vector2d(d, 1.5 * d);
      pair.windows = 3 * d;
      pairs.push_back(pair);
    }
  return pairs;
}

}  // namespace

TEST_CASE("Folds keep a clip together and spread the classes") {
  const std::vector<std::size_t> labels{0, 1, 0, 1, 0, 1, 0, 2, 2};
  const auto own = deal_folds(labels, 0);
  for (std::size_t i = 0; i < labels.size(); ++i) CHECK(own[i] == i);
  const auto three = deal_folds(labels, 3);
  for (std::size_t fold = 0; fold < 3; ++fold) CHECK(std::ranges::count(three, fold) == 3);
  for (std::size_t label = 0; label < 2; ++label) {
    std::vector<int> of_fold(3);
    for (std::size_t i = 0; i < labels.size(); ++i)
      if (labels[i] == label) ++of_fold[three[i]];
    CHECK(std::ranges::max(of_fold) - std::ranges::min(of_fold) <= 1);
  }
  CHECK(three == deal_folds(labels, 3));
  for (const std::size_t bad : {1, 10})
    CHECK(message_of<core::InputError>([&] { deal_folds(labels, bad); }) ==
          "folds is " + std::to_string(bad) +
              ", allowed is 0 (a fold for every clip) and 2 to 9, the number of clips");
}

TEST_CASE("Blocks of one clip do not tell each other's label") {
  // Every clip's blocks are near each other and far from all else, and labels are random. With blocks of one
  // clip on both sides the classifier would always be right. Left out together, they cannot be classified.
  constexpr std::size_t kClips = 40, kBlocks = 5;
  SampleLabels samples;
  samples.classes = 2;
  std::vector<std::size_t> clip_of, clip_labels;
  core::Rng rng(5);
  for (std::size_t clip = 0; clip < kClips; ++clip) clip_labels.push_back(rng.below(2));
  for (const std::size_t folds : {0, 4}) {
    const auto fold_of = deal_folds(clip_labels, folds);
    samples.label.clear(), samples.fold.clear(), clip_of.clear();
    for (std::size_t clip = 0; clip < kClips; ++clip)
      for (std::size_t block = 0; block < kBlocks; ++block) {
        clip_of.push_back(clip);
        samples.label.push_back(clip_labels[clip]);
        samples.fold.push_back(fold_of[clip]);
      }
    const auto pairs = grouped(clip_of);
    const auto honest = cross_validate(samples, pairs);
    REQUIRE(honest.size() == 8);
    for (const auto& result : honest) {
      CAPTURE(name(result.measure), name(result.classifier), folds);
      CHECK(result.accuracy < 0.72);
    }
    auto straddling = samples;
    for (std::size_t i = 0; i < clip_of.size(); ++i) straddling.fold[i] = i % kBlocks;
    for (const auto& result : cross_validate(straddling, pairs)) {
      CAPTURE(name(result.measure), name(result.classifier));
      CHECK(result.accuracy > 0.9);
    }
  }
}

TEST_CASE("Both classifiers know what lies in groups by every measure") {
  SampleLabels samples;
  samples.classes = 4;
  for (std::size_t i = 0; i < 32; ++i) {
    samples.label.push_back(i % 4);
    samples.fold.push_back(i);
  }
  const auto results = cross_validate(samples, grouped(samples.label));
  REQUIRE(results.size() == 8);
  for (const auto& result : results) {
    CAPTURE(name(result.measure), name(result.classifier));
    CHECK(result.accuracy == 1);
    CHECK(std::ranges::equal(result.predicted, samples.label));
    CHECK(result.samples == 32);
    CHECK(cv::sum(result.confusion)[0] == 32);
    CHECK(cv::trace(result.confusion)[0] == 32);
  }
  CHECK_FALSE(message_of<core::InputError>([&] { cross_validate(samples, {}); }).empty());
}

TEST_CASE("A sample without KL is left out of KL alone, and changes nothing for the others") {
  // Sample 5 lies nearest to all, so it would mislead whom it could.
  constexpr std::size_t kLone = 5;
  SampleLabels samples, others;
  samples.classes = others.classes = 3;
  for (std::size_t i = 0; i < 18; ++i) {
    samples.label.push_back(i % 3);
    samples.fold.push_back(i / 3);
    if (i == kLone) continue;
    others.label.push_back(i % 3);
    others.fold.push_back(i / 3);
  }
  auto pairs = grouped(samples.label);
  std::vector<dytex::Distances> without;
  std::size_t k = 0;
  for (std::size_t i = 0; i < 18; ++i)
    for (std::size_t j = i; j < 18; ++j, ++k) {
      if (i == kLone || j == kLone)
        pairs[k].kl.reset(), pairs[k].kl_back.reset();
      else
        without.push_back(pairs[k]);
    }
  const auto results = cross_validate(samples, pairs), expected = cross_validate(others, without);
  REQUIRE(results.size() == 8);
  REQUIRE(expected.size() == 8);
  for (std::size_t r = 0; r < 8; ++r) {
    CAPTURE(name(results[r].measure), name(results[r].classifier));
    const bool kl = results[r].measure == dytex::Measure::kl;
    CHECK(results[r].samples == (kl ? 17 : 18));
    CHECK(results[r].predicted[kLone].has_value() != kl);
    CHECK(results[r].accuracy == 1);
    CHECK(cv::sum(results[r].confusion)[0] == (kl ? 17 : 18));
    if (!kl) continue;
    auto predicted = results[r].predicted;
    predicted.erase(predicted.begin() + kLone);
    CHECK(predicted == expected[r].predicted);
  }
  // By a measure that no two samples have none is classified, and it is left out.
  for (auto& pair : pairs) pair.kl.reset(), pair.kl_back.reset();
  CHECK(cross_validate(samples, pairs).size() == 6);
}

TEST_CASE("One model without noise leaves the others their KL") {
  const TempFolder temp;
  std::vector<std::string> noisy{learn_texture(write_waves(temp / "a", {0.3, 0.95}, 1), temp / "ma"),
                                 learn_texture(write_waves(temp / "b", {1.5, 0.95}, 2), temp / "mb")};
  const auto exact = learn_texture(write_waves(temp / "c", {}, 3, {24, 20}, 8), temp / "mc", "7");
  const std::vector<std::string> all{noisy[0], exact, noisy[1]};
  const auto out = (temp / "out").string();
  const auto told =
      run_command(joined({"dytex", "distance"}, all, {"--measure", "kl", "--growth", "9", "-o", out}));
  INFO(told.err);
  REQUIRE(told.exit == 0);
  CHECK(std::ranges::count(told.err, '\n') >= 1);
  const auto first = told.err.find(exact + ": its noise r is 0, so pairs with it have no KL rate");
  CHECK(first != std::string::npos);
  CHECK(told.err.find("noise r is 0", first + exact.size() + 20) == std::string::npos);  // once
  const Json kl = Json::parse(bytes_of(temp / "out" / "matrix.json"))["measures"]["kl"];
  const Json alone =
      Json::parse(run_command(joined({"dytex", "distance"}, noisy, {"--json", "-q"})).out)["measures"]["kl"];
  CHECK(kl[0][2] == alone[0][1]);
  CHECK(kl[2][0] == alone[1][0]);
  for (const auto& [i, j] : {std::pair{0, 1}, {1, 0}, {1, 1}, {1, 2}, {2, 1}}) CHECK(kl[i][j].is_null());
  CHECK(contains(bytes_of(temp / "out" / "matrix.csv"), "\nmc,,,\n"));
  const auto row = told.out.find("\nmc ");
  REQUIRE(row != std::string::npos);
  const std::string line = told.out.substr(row, told.out.find('\n', row + 1) - row);
  CHECK(std::ranges::count(line, '-') == 3);
  const Json growth = Json::parse(bytes_of(temp / "out" / "growth.json"));
  REQUIRE(growth["curves"].size() == 1);
  CHECK(growth["curves"][0]["to"] == "mb");
  // Of the model without noise itself there is no curve.
  check_one_line({"dytex", "distance", exact, noisy[0], noisy[1], "--growth", "9", "-o", out, "-q"}, 1,
                 {exact, "noise r is 0"}, (temp / "none").string());
}

TEST_CASE("dytex classify leaves a clip without noise out of KL alone") {
  const TempFolder temp;
  const auto folder = write_classes(temp / "classes", 3);
  // A clip of as many frames as its model has directions.
  learn_texture(write_waves(temp / "short", {0.9, 0.9}, 40, {24, 20}, 8),
                temp / "classes" / "medium" / "exact", "7");
  const auto out = temp / "out";
  const auto told = run_command({"dytex", "classify", folder, "-o", out.string(), "-n", "8"});
  INFO(told.err);
  REQUIRE(told.exit == 0);
  CHECK(contains(told.err, "medium/exact: the noise r is 0"));
  const auto line_of = [&](const std::string& measure) {
    const auto at = told.out.find("\n" + measure + " ") + 1;
    return told.out.substr(at, told.out.find('\n', at) - at);
  };
  CHECK(line_of("kl").ends_with("of 9 samples"));
  CHECK_FALSE(contains(line_of("martin"), "samples"));
  const Json found = Json::parse(bytes_of(out / "classification.json"));
  REQUIRE(found["methods"].size() == 8);
  for (const Json& method : found["methods"])
    CHECK(method["samples"] == (method["measure"] == "kl" ? 9 : 10));
  const auto csv = bytes_of(out / "predictions.csv");
  const auto at = csv.find("\"medium/exact\",\"medium\",");
  REQUIRE(at != std::string::npos);
  const auto row = csv.substr(at, csv.find('\n', at) - at);
  CHECK(std::ranges::count(row, ',') == 10);
  std::size_t empty = 0;
  for (auto comma = row.find(",,"); comma != std::string::npos; comma = row.find(",,", comma + 1)) ++empty;
  CHECK(empty == 2);
}

TEST_CASE("dytex classify knows synthetic classes by their dynamics") {
  const TempFolder temp;
  const auto folder = write_classes(temp / "classes", 4, {49, 21});
  for (const std::string threads : {"1", "2", "8"}) {
    const auto result = run_command({"dytex", "classify", folder, "-o", (temp / ("out" + threads)).string(),
                                     "--blocks", "2x1", "-n", "8", "--threads", threads});
    INFO(result.err);
    REQUIRE(result.exit == 0);
    CHECK(contains(result.out, "24 samples of 12 clips in 3 classes"));
    for (const char* name : {"classification.json", "confusion.png", "predictions.csv"})
      CHECK(bytes_of(temp / ("out" + threads) / name) == bytes_of(temp / "out1" / name));
  }
  const Json found = Json::parse(bytes_of(temp / "out1" / "classification.json"));
  CHECK(found["classes"] == Json({"medium", "quick", "slow"}));
  CHECK(found["samples"] == 24);
  REQUIRE(found["methods"].size() == 8);
  for (const auto& method : found["methods"]) {
    CAPTURE(method["measure"].get<std::string>(), method["classifier"].get<std::string>());
    int hits = 0, all = 0;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        const int count = method["confusion"][i][j].get<int>();
        all += count;
        if (i == j) hits += count;
      }
    CHECK(all == 24);
    CHECK_THAT(method["accuracy"].get<double>(), WithinAbs(hits / 24.0, 1e-12));
    // KL tells appearance apart to the noise's level, r = 4, which 60 frames do not teach: chance is a third.
    CHECK(method["accuracy"] >= (method["measure"] == "kl" ? 0.55 : 0.95));
  }
  CHECK(std::ranges::count(bytes_of(temp / "out1" / "predictions.csv"), '\n') == 25);
  CHECK(cv::imread((temp / "out1" / "confusion.png").string()).cols > 400);
}

TEST_CASE("dytex classify finds nothing where labels mean nothing") {
  // Each class has clips of every kind.
  const TempFolder temp;
  std::uint64_t seed = 1;
  const std::vector<Waves> kinds{{0.15, 0.97}, {0.9, 0.9}, {2, 0.95}};
  for (std::size_t i = 0; i < 18; ++i)
    write_waves(temp / "classes" / ("class" + std::to_string(i % 3)) / ("clip" + std::to_string(i)),
                kinds[i / 3 % 3], seed++);
  const auto result = run_command(
      {"dytex", "classify", (temp / "classes").string(), "-o", (temp / "out").string(), "-n", "8", "--json"});
  REQUIRE(result.exit == 0);
  const Json found = Json::parse(result.out);
  for (const auto& method : found["methods"]) CHECK(method["accuracy"] < 0.67);
}

TEST_CASE("dytex classify knows a texture at another place and in frames of another size by its windows") {
  // One class runs up, one down; each clip is another part of the waves, and only half as bright.
  const TempFolder temp;
  for (int i = 0; i < 6; ++i) {
    const cv::Size size(40 + 8 * (i / 2), 64 - 8 * (i / 2));
    const auto folder = temp / "classes" / (i % 2 == 0 ? "down" : "up");
    fs::create_directories(folder);
    const auto writer = io::create_video(folder / ("clip" + std::to_string(i)), size, 25, false);
    core::Rng rng(static_cast<std::uint64_t>(i));
    const double phase = rng.uniform(0, 7), contrast = rng.uniform(10, 40);
    for (int t = 0; t < 50; ++t) {
      cv::Mat1f levels(size);
      for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
          levels(y, x) = static_cast<float>(
              100 + 10 * i + contrast * std::sin(0.2 * x + 0.8 * y + (i % 2 == 0 ? -0.6 : 0.6) * t + phase) +
              contrast / 10 * rng.normal());
      writer->write(core::to_bytes(levels));
    }
    writer->finish();
  }
  const auto result = run_command(
      {"dytex", "classify", (temp / "classes").string(), "-o", (temp / "out").string(), "-n", "4", "--json"});
  INFO(result.err);
  REQUIRE(result.exit == 0);
  int told = 0;
  const Json found = Json::parse(result.out);
  for (const Json& method : found["methods"]) {
    if (method["measure"] != "windows") continue;
    CHECK(method["accuracy"] == 1);
    ++told;
  }
  CHECK(told == 2);
}

TEST_CASE("dytex classify says which samples have no windows") {
  const TempFolder temp;
  const auto folder = write_classes(temp / "classes", 2);
  write_waves(temp / "classes" / "slow" / "short", {0.15, 0.97}, 30, {24, 20}, 31);
  const auto result = run_command({"dytex", "classify", folder, "-o", (temp / "out").string(), "-n", "8"});
  CHECK(result.exit == 0);
  CHECK(contains(result.err, "slow/short: no windows of 16x16 that move for 32 frames"));
  const auto line = result.out.substr(result.out.find("\nwindows ") + 1);
  CHECK(contains(line.substr(0, line.find('\n')), "of 6 samples"));
}

TEST_CASE("dytex classify takes models beside clips") {
  const TempFolder temp;
  write_classes(temp / "classes", 2);
  for (const std::string kind : {"slow", "medium", "quick"}) {
    const auto clip = temp / "classes" / kind / "clip0";
    learn_texture(clip.string(), temp / "classes" / kind / "model");
    fs::remove_all(clip);
  }
  std::ofstream(temp / "classes" / "README.txt") << "what this is";
  const auto result = run_command(
      {"dytex", "classify", (temp / "classes").string(), "-o", (temp / "out").string(), "-n", "8", "--json"});
  INFO(result.err);
  REQUIRE(result.exit == 0);
  CHECK(contains(result.err, "README.txt is passed over"));
  const Json json = Json::parse(result.out);
  CHECK(json["samples"] == 6);
  CHECK(std::ranges::count_if(json["clips"], [](const Json& clip) { return clip["model"].get<bool>(); }) ==
        3);
  for (const Json& method : json["methods"])
    if (method["measure"] == "martin" && method["classifier"] == "nearest") CHECK(method["accuracy"] == 1);
}

TEST_CASE("What dytex classify cannot take is refused in one line") {
  const TempFolder temp;
  const auto folder = write_classes(temp / "classes", 2), out = (temp / "out").string();
  const auto refused = [&](const std::vector<std::string>& more, int exit,
                           const std::vector<std::string>& what) {
    check_one_line(joined({"dytex", "classify"}, more, {"-o", out, "-q"}), exit, what, out);
  };
  refused({folder, "--blocks", "2"}, 2, {"--blocks is 2", "COLUMNSxROWS"});
  refused({folder, "--blocks", "0x2"}, 2, {"--blocks: columns is 0", "1 to 64"});
  refused({folder, "--blocks", "64x1"}, 1, {"too small"});
  refused({folder, "--pieces", "0"}, 2, {"--pieces is 0", "1 to 64"});
  refused({folder, "-n", "0"}, 2, {"--components is 0"});
  refused({folder, "-n", "59"}, 2, {"--components is 59", "60 frames", "1 to 58"});
  refused({folder, "--pieces", "10", "-n", "5"}, 2, {"6 frames", "1 to 4"});
  refused({folder, "--folds", "1"}, 2, {"--folds is 1"});
  refused({folder, "--folds", "7"}, 2, {"--folds is 7", "2 to 6"});
  refused({folder, "--range", "9:3"}, 2, {"--range"});
  refused({(temp / "none").string()}, 1, {"none", "is no folder"});
  refused({(temp / "classes" / "slow").string()}, 1, {"clip0 holds images itself"});
  fs::create_directories(temp / "one" / "class");
  refused({(temp / "one").string()}, 1, {"class has no clip"});
  write_waves(temp / "one" / "class" / "a", {}, 1);
  write_waves(temp / "one" / "class" / "b", {}, 1);
  refused({(temp / "one").string()}, 1, {"holds 1 class;"});
  write_strokes(temp / "classes" / "slow" / "colour", {24, 20}, 30);
  refused({folder, "-n", "5"}, 1, {"colour", "--grey"});
  const auto lone = run_command({"dytex", "classify", folder, "-o", out, "-n", "5", "--grey", "-q"});
  CHECK(lone.exit == 0);
}
