// SPDX-License-Identifier: Apache-2.0
#include "apps/sketching/sketch_dictionary.hpp"

#include <algorithm>
#include <string>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "apps/sketching/dictionary_picture.hpp"
#include "core/io/model_folder.hpp"
#include "tests/apps/commands/command_check.hpp"

using namespace emberfold;
using namespace emberfold::apps;
using namespace emberfold::test;

namespace {

// Bytes of every file of a dictionary, its picture and what was drawn with it.
std::string all_bytes(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder / "dictionary")) files.push_back(entry.path());
  std::ranges::sort(files);
  files.push_back(folder / "dictionary.png");
  files.push_back(folder / "reconstruction.avi");
  std::string all;
  for (const auto& file : files) all += bytes_of(file);
  return all;
}

}  // namespace

TEST_CASE("sketch learns a dictionary and draws with it and with one learned before") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {160, 120}, 5);
  const auto made = temp / "made", used = temp / "used", fitted = temp / "fitted";
  const auto learned =
      run_command({"sketch", clip, "-o", made.string(), "--learn-dictionary", "--patches", "learned", "-q"});
  INFO(learned.err);
  REQUIRE(learned.exit == 0);
  const auto dictionary = sketch::read_dictionary(io::read_model(made / "dictionary", io::kDictionaryFormat));
  REQUIRE_FALSE(dictionary.entries.empty());
  const Json told = summary_of(made)["dictionary"];
  REQUIRE(told["entries"].size() == dictionary.entries.size());
  std::uint64_t seen = 0;
  for (const auto& entry : told["entries"]) seen += entry["seen"].get<std::uint64_t>();
  const auto patches = summary_of(made)["per_frame"]["patches"].get<std::vector<double>>();
  double all = 0;
  for (const double count : patches) all += count;
  CHECK(double(seen) <= all + double(dictionary.entries.size()));
  CHECK(double(seen) >= 0.9 * all);
  CHECK(told["coded_share"] > 0.9);
  CHECK(told["residual_profiles"]["learned"] < told["residual_profiles"]["parametric"]);
  CHECK(told["cost"]["learned"] > 0);
  const cv::Mat picture = cv::imread((made / "dictionary.png").string());
  CHECK(picture.size() == draw_dictionary(dictionary).size());

  // Read back, the dictionary draws equal bytes; it is not written again.
  REQUIRE(run_command({"sketch", clip, "-o", used.string(), "--dictionary", (made / "dictionary").string(),
                       "--patches", "learned", "-q"})
              .exit == 0);
  CHECK(bytes_of(used / "reconstruction.avi") == bytes_of(made / "reconstruction.avi"));
  CHECK(bytes_of(used / "sketch.jsonl") == bytes_of(made / "sketch.jsonl"));
  CHECK_FALSE(fs::exists(used / "dictionary"));
  CHECK(summary_of(used)["dictionary"] == told);

  // The dictionary does not change the sketch, nor a drawing without it.
  REQUIRE(run_command({"sketch", clip, "-o", fitted.string(), "-q"}).exit == 0);
  CHECK(bytes_of(fitted / "sketch.jsonl") == bytes_of(made / "sketch.jsonl"));
  CHECK_FALSE(summary_of(fitted).contains("dictionary"));
  CHECK(summary_of(made)["sketch"]["psnr"]["mean"].get<double>() >
        summary_of(fitted)["sketch"]["psnr"]["mean"].get<double>() - 0.5);
}

TEST_CASE("A dictionary is the same at one thread and at four") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {120, 90}, 4);
  std::array<std::string, 2> bytes;
  for (const int i : {0, 1}) {
    const auto out = temp / std::to_string(i);
    REQUIRE(run_command({"sketch", clip, "-o", out.string(), "--learn-dictionary", "--patches", "learned",
                         "-q", "--threads", i == 0 ? "1" : "4"})
                .exit == 0);
    bytes[static_cast<std::size_t>(i)] = all_bytes(out);
  }
  CHECK_FALSE(bytes[0].empty());
  CHECK(bytes[0] == bytes[1]);
}

TEST_CASE("What is wrong with a dictionary is told in one line") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {120, 90}, 3);
  const auto out = temp / "out";
  const auto refused = [&](std::vector<std::string> more, int exit, const std::vector<std::string>& what) {
    check_one_line(joined({"sketch", clip, "-o", out.string()}, more, {"-q"}), exit, what, out);
  };
  refused({"--patches", "learned"}, 2, {"--learn-dictionary", "--dictionary"});
  refused({"--learn-dictionary", "--dictionary", "x"}, 2, {"--learn-dictionary", "--dictionary"});
  refused({"--dictionary", (temp / "none").string()}, 1, {"none", "no such"});
  refused({"--dictionary", clip}, 1, {"clip", "sketch --learn-dictionary"});

  const auto made = temp / "made";
  REQUIRE(run_command({"sketch", clip, "-o", made.string(), "--learn-dictionary", "-q"}).exit == 0);
  refused({"--dictionary", made.string()}, 1, {"there is one in it", "dictionary"});
  const auto folder = made / "dictionary";
  check_one_line({"synth", folder.string(), "-o", (temp / "new.avi").string(), "-q"}, 1,
                 {"a dictionary", "emberfold sketch --dictionary"}, temp / "new.avi");
  fs::remove(folder / "seen.npy");
  refused({"--dictionary", folder.string(), "--patches", "learned"}, 1, {"seen.npy is missing"});
}

TEST_CASE("A clip without strokes gives an empty dictionary that can be used") {
  const TempFolder temp;
  const auto writer = io::create_video(temp / "flat", {64, 48}, 25, true);
  for (int t = 0; t < 2; ++t) writer->write(cv::Mat(48, 64, CV_8UC3, cv::Scalar(90, 120, 60)));
  writer->finish();
  const auto out = temp / "out", again = temp / "again";
  REQUIRE(run_command({"sketch", (temp / "flat").string(), "-o", out.string(), "--learn-dictionary",
                       "--patches", "learned", "-q"})
              .exit == 0);
  CHECK(summary_of(out)["dictionary"]["entries"].empty());
  CHECK(summary_of(out)["dictionary"]["coded_share"].is_null());
  REQUIRE_FALSE(cv::imread((out / "dictionary.png").string()).empty());
  CHECK(run_command({"sketch", (temp / "flat").string(), "-o", again.string(), "--dictionary",
                     (out / "dictionary").string(), "--patches", "learned", "-q"})
            .exit == 0);
}
