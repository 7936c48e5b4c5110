// SPDX-License-Identifier: Apache-2.0
// The table of bad and odd inputs: what is told, with which exit status, and that nothing is lost.
#include <fstream>
#include <limits>
#include <map>
#include <system_error>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sys/stat.h>

#include "tests/apps/commands/command_check.hpp"
#include "tests/support/tiff_writer.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

using Words = std::vector<std::string>;

void put(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

void put_image(const fs::path& path, const cv::Mat& image) {
  REQUIRE(cv::imwrite(path.string(), image));
}

void cut(const fs::path& from, const fs::path& to, double share) {
  const std::string bytes = bytes_of(from);
  put(to, bytes.substr(0, static_cast<std::size_t>(share * static_cast<double>(bytes.size()))));
}

/// A frame with a bright line, of any depth.
cv::Mat lined(int t, int type = CV_8UC1, double white = 255, cv::Size size = {40, 32}) {
  cv::Mat frame(size, type, cv::Scalar::all(white * 0.2));
  cv::line(frame, {4, 8 + t}, {size.width - 6, 12 + t}, cv::Scalar::all(white * 0.9), 3);
  return frame;
}

std::vector<cv::Mat> lines(int frames, int type = CV_8UC1, double white = 255) {
  std::vector<cv::Mat> all;
  for (int t = 0; t < frames; ++t) all.push_back(lined(t, type, white));
  return all;
}

void put_clip(const fs::path& path, int frames, cv::Size size = {40, 32}) {
  const auto writer = io::create_video(path, size, 25, false);
  for (int t = 0; t < frames; ++t) writer->write(lined(t, CV_8UC1, 255, size));
  writer->finish();
}

void put_sequence(const fs::path& folder, const Words& names, int type = CV_8UC1) {
  fs::create_directory(folder);
  int t = 0;
  for (const auto& name : names) put_image(folder / name, lined(t++, type));
}

std::string imagej(const std::string& rest) {
  return "ImageJ=1.54f\n" + rest;
}

/// Everything that the table reads.
struct Inputs {
  TempFolder temp;

  Inputs() {
    clips();
    pictures();
    stacks();
    fs::create_directory_symlink(at("loop"), at("loop"));
    fs::create_symlink(at("nowhere"), at("dangling"));
    fs::create_directory(at("model"));
    put(at("model/model.json"), R"({"format": "emberfold.motion_model"})");
    fs::create_directory(at("own"));
    put(at("own/overlay.mp4"), "mine");
  }
  [[nodiscard]] std::string at(const std::string& name) const { return (temp / name).string(); }

 private:
  void clips() const {
    put_clip(at("clip.avi"), 3);
    put_clip(at("odd.mp4"), 3, {39, 31});
    put_clip(at("name with 'quotes' and spaces.avi"), 2);
    put_clip(at("50%.avi"), 2);
    put_clip(at("\u706b.avi"), 2);
    fs::copy_file(at("clip.avi"), at("wrong_name.mp4"));
    cut(at("clip.avi"), at("head.avi"), 0.02);
    put(at("empty.mp4"), "");
    put(at("text.mp4"), "this is no clip\n");
    put_sequence(at("frames"), {"f0.png", "f1.png", "f2.png"});
    put_sequence(at("gap"), {"f0.png", "f1.png", "f4.png"});
    put_sequence(at("upper"), {"A.PNG", "B.PNG"});
    put_sequence(at("sizes"), {"f0.png"});
    put_image(at("sizes/f1.png"), lined(1, CV_8UC1, 255, {41, 32}));
    put_sequence(at("depths"), {"f0.png"});
    put_image(at("depths/f1.png"), lined(1, CV_16UC1, 65535));
    put_sequence(at("colours"), {"f0.png"});
    put_image(at("colours/f1.png"), lined(1, CV_8UC3));
    fs::create_directory(at("no images"));
    put(at("no images/notes.txt"), "x");
    fs::create_directory(at("empty"));
    put_sequence(at("with notes"), {"f0.png", "f1.png"});
    put(at("with notes/notes.txt"), "x");
  }
  void pictures() const {
    put_image(at("dot.png"), cv::Mat(1, 1, CV_8UC1, cv::Scalar(9)));
    put_image(at("black.png"), cv::Mat(32, 40, CV_8UC1, cv::Scalar(0)));
    put_image(at("mask.png"), cv::Mat(32, 40, CV_8UC1, cv::Scalar(1)));
    put_image(at("small.png"), cv::Mat(5, 5, CV_8UC1, cv::Scalar(255)));
    put_image(at("whole.png"), lined(0, CV_8UC3));
    put_image(at("whole.jpg"), lined(0, CV_8UC3));
    cut(at("whole.png"), at("cut.png"), 0.6);
    cut(at("whole.jpg"), at("cut.jpg"), 0.6);
    put(at("text.png"), "no picture");
    put(at("text.tif"), "no picture");
  }
  void stacks() const {
    write_tiff(at("stack.tif"), lines(3, CV_16UC1, 4095));
    write_tiff(at("big_endian.tif"), lines(3, CV_16UC1, 4095), {"", 0, 0, 1, true});
    write_tiff(at("floats.tif"), lines(3, CV_32FC1, 1));
    write_tiff(at("high_floats.tif"), lines(3, CV_32FC1, 900));
    write_tiff(at("dim.tif"),
               {cv::Mat(32, 40, CV_16UC1, cv::Scalar(3000)), cv::Mat(32, 40, CV_16UC1, cv::Scalar(3090))});
    write_tiff(at("one_head.tif"), lines(3, CV_16UC1, 4095),
               {imagej("images=3\nframes=3\n"), 0, 0, 1, true, true});
    write_tiff(at("channels.tif"), lines(4), {imagej("images=4\nchannels=2\nframes=2\nfinterval=0.5\n")});
    write_tiff(at("slices.tif"), lines(4), {imagej("images=4\nslices=4\n")});
    write_tiff(at("volumes.tif"), lines(6), {imagej("images=6\nslices=3\nframes=2\n")});
    write_tiff(at("wrong_head.tif"), lines(4), {imagej("images=4\nchannels=3\nframes=7\n")});
    write_tiff(at("two_sizes.tif"), {lined(0), lined(0, CV_8UC1, 255, {41, 32})});
    auto broken = lines(2, CV_32FC1, 1);
    broken[1].at<float>(3, 3) = std::numeric_limits<float>::quiet_NaN();
    write_tiff(at("nan.tif"), broken);
    write_tiff(at("files.ome.tif"), lines(2),
               {R"(<OME><Image><Pixels SizeT="2"><TiffData><UUID FileName="a.tif"/></TiffData>)"
                R"(<TiffData><UUID FileName="b.tif"/></TiffData></Pixels></Image></OME>)"});
    write_tiff(at("early.ome.tif"), lines(2), {R"(<OME><Image><Pixels SizeT="5"/></Image></OME>)"});
    cut(at("one_head.tif"), at("cut_one_head.tif"), 0.5);
    cut(at("stack.tif"), at("cut.tif"), 0.7);
  }
};

struct Case {
  std::string what;
  Words arguments;  ///< after "sketch"
  int exit;
  Words told;  ///< parts of what is told; at exit 0 of the warnings
  std::string out_name = "out";
};

std::vector<Case> unreadable(const Inputs& in) {
  const auto at = [&](const char* name) { return in.at(name); };
  return {
      {"no such file", {at("nothing.mp4")}, 1, {"nothing.mp4", "no such file"}},
      {"an empty name", {""}, 1, {"empty"}},
      {"an empty file", {at("empty.mp4")}, 1, {"empty.mp4", "empty"}},
      {"text with a video's name", {at("text.mp4")}, 1, {"text.mp4", "no video"}},
      {"text with an image's name", {at("text.png")}, 1, {"text.png", "no image"}},
      {"text with a TIFF's name", {at("text.tif")}, 1, {"text.tif"}},
      {"an empty folder", {at("empty")}, 1, {"empty", "no images"}},
      {"a folder without images", {at("no images")}, 1, {"no images"}},
      {"a pattern that nothing fits", {at("frames/g*.png")}, 1, {"g*.png", "no file fits"}},
      {"a pattern in no folder", {at("nofolder/g*.png")}, 1, {"nofolder"}},
      {"a PNG that is cut off", {at("cut.png")}, 1, {"cut.png", "cut off"}},
      {"a JPEG that is cut off", {at("cut.jpg")}, 1, {"cut.jpg", "cut off"}},
      {"a TIFF that is cut off", {at("cut.tif")}, 1, {"cut.tif"}},
      {"a large stack that is cut off", {at("cut_one_head.tif")}, 1, {"cut_one_head.tif"}},
      {"the head of a video", {at("head.avi")}, 1, {"head.avi"}},
      {"images of two sizes", {at("sizes")}, 1, {"f1.png", "41x32", "40x32"}},
      {"images of two depths", {at("depths")}, 1, {"f1.png", "16 bits"}},
      {"colour among grey images", {at("colours")}, 1, {"f1.png", "colour"}},
      {"a model for a clip", {at("model")}, 1, {"model"}},
      {"pages of two sizes", {at("two_sizes.tif")}, 1, {"two_sizes.tif", "page 1"}},
      {"a stack in several files", {at("files.ome.tif")}, 1, {"2 files", "a.tif"}},
      {"a link to nothing", {at("dangling")}, 1, {"dangling"}},
      {"a link to itself", {at("loop")}, 1, {"loop"}},
      {"a device that is empty", {"/dev/null"}, 1, {"/dev/null", "empty"}},
      {"a built-in clip that is none", {"builtin:smoke"}, 1, {"smoke", "fire"}},
      {"a mask that is not there", {at("clip.avi"), "--mask", at("nomask.png")}, 1, {"nomask.png"}},
      {"a mask of another size",
       {at("clip.avi"), "--mask", at("small.png")},
       1,
       {"small.png", "5x5", "40x32"}},
      {"a mask that leaves nothing",
       {at("clip.avi"), "--mask", at("black.png")},
       1,
       {"black.png", "nothing"}},
      {"a region outside of the frame", {at("clip.avi"), "--roi", "30,0,20,20"}, 1, {"30,0,20,20", "40x32"}},
      {"a channel that is not there", {at("channels.tif"), "--channel", "2"}, 1, {"channel 2", "0 to 1"}},
      {"a slice that is not there", {at("volumes.tif"), "--slice", "3"}, 1, {"slice 3", "0 to 2"}},
      {"a slice of a video", {at("clip.avi"), "--slice", "1"}, 1, {"clip.avi", "no slices"}},
      {"a range behind the end", {at("clip.avi"), "--range", "9:"}, 1, {"frame 9", "3 frames"}},
  };
}

std::vector<Case> misused(const Inputs& in) {
  const std::string clip = in.at("clip.avi");
  return {
      {"a region that is none", {clip, "--roi", "1,2,3"}, 2, {"--roi", "1,2,3", "X,Y,WIDTH,HEIGHT"}},
      {"a region without area", {clip, "--roi", "0,0,0,5"}, 2, {"--roi", "0,0,0,5"}},
      {"an empty range", {clip, "--range", "2:2"}, 2, {"--range", "2:2"}},
      {"a range that is none", {clip, "--range", "2"}, 2, {"--range", "2"}},
      {"every 0th frame", {clip, "--every", "0"}, 2, {"--every", "0", "1 to"}},
      {"no rate", {clip, "--fps", "0"}, 2, {"--fps", "0", "above 0"}},
      {"a rate that is no number", {clip, "--fps", "nan"}, 2, {"--fps", "nan"}},
      {"a length without a unit", {clip, "--pixel-size", "5"}, 2, {"--pixel-size", "5", "um"}},
      {"a negative length", {clip, "--pixel-size", "-1um"}, 2, {"--pixel-size", "above 0"}},
      {"levels upside down", {clip, "--levels", "9:2"}, 2, {"--levels", "9:2"}},
      {"levels that are none", {clip, "--levels", "most"}, 2, {"--levels", "most", "auto"}},
      {"a negative channel", {clip, "--channel", "-1"}, 2, {"--channel", "-1"}},
      {"a slice that is none", {clip, "--slice", "top"}, 2, {"--slice", "top"}},
      {"a size of nothing", {clip, "--scale", "0"}, 2, {"--scale", "0"}},
      {"a way to stabilize that is none",
       {clip, "--stabilize", "yes"},
       2,
       {"--stabilize", "yes", "translation"}},
      {"an option in the place of a value",
       {clip, "--stabilize", "--fps", "2"},
       2,
       {"--stabilize needs", "--fps"}},
      {"an option that is none", {clip, "--chanel", "1"}, 2, {"--chanel", "--channel"}},
      {"the clip's folder for the result", {in.at("frames")}, 2, {"frames"}, "frames"},
      {"a folder with a file of that name", {clip}, 2, {"overlay.mp4", "--overwrite"}, "own"},
      {"a file for the result", {clip}, 1, {"text.mp4"}, "text.mp4"},
      {"a result below a file", {clip}, 1, {"text.mp4"}, "text.mp4/out"},
  };
}

std::vector<Case> odd(const Inputs& in) {
  const auto at = [&](const char* name) { return in.at(name); };
  return {
      {"one pixel", {at("dot.png")}, 0, {}},
      {"a black picture", {at("black.png")}, 0, {}},
      {"numbers that are missing", {at("gap")}, 0, {"2 numbers are missing", "f1.png and f4.png"}},
      {"upper case names", {at("upper")}, 0, {"--fps"}},
      {"a slash behind the folder", {at("frames") + "/"}, 0, {"--fps"}},
      {"other files beside the images", {at("with notes")}, 0, {}},
      {"quotes and spaces", {at("name with 'quotes' and spaces.avi")}, 0, {}},
      {"a percent sign", {at("50%.avi")}, 0, {}},
      {"a name in another script", {at("\u706b.avi")}, 0, {}},
      {"another container than the name says", {at("wrong_name.mp4")}, 0, {}},
      {"an odd size", {at("odd.mp4")}, 0, {}},
      {"12 of 16 bits", {at("stack.tif"), "--fps", "2"}, 0, {}},
      {"the other order of bytes", {at("big_endian.tif"), "--fps", "2"}, 0, {}},
      {"floats up to 1", {at("floats.tif"), "--fps", "2"}, 0, {}},
      {"floats that are none", {at("nan.tif"), "--fps", "2"}, 0, {"no finite numbers", "masked"}},
      {"floats above 1", {at("high_floats.tif"), "--fps", "2"}, 0, {"floats", "is taken as white"}},
      {"a small part of the levels", {at("dim.tif"), "--fps", "2"}, 0, {"--levels 3000:3090"}},
      {"one head for all pages", {at("one_head.tif")}, 0, {"--fps"}},
      {"channels that nobody chose", {at("channels.tif")}, 0, {"2 channels", "--channel"}},
      {"slices that nobody chose", {at("volumes.tif")}, 0, {"3 slices", "--slice"}},
      {"frames that are called slices", {at("slices.tif")}, 0, {"slices by its head"}},
      {"a head that does not fit", {at("wrong_head.tif")}, 0, {"every page is taken as a frame"}},
      {"fewer frames than planned", {at("early.ome.tif")}, 0, {"only 2 of the 5 frames"}},
      {"a range that ends behind the end", {at("clip.avi"), "--range", "1:9"}, 0, {"3 frames"}},
      {"a mask of 0 and 1", {at("clip.avi"), "--mask", at("mask.png")}, 0, {}},
      {"a foreign file that may be replaced", {at("clip.avi"), "--overwrite"}, 0, {}, "own"},
  };
}

void check_case(const Inputs& in, const Case& one) {
  const fs::path out = in.at(one.out_name);
  INFO(one.what);
  const auto before = snapshot(in.temp.path());
  Words words{"sketch"};
  words.insert(words.end(), one.arguments.begin(), one.arguments.end());
  words.insert(words.end(), {"-o", out.string(), "-q"});
  const auto result = run_command(words);
  INFO(result.err);
  CHECK(result.exit == one.exit);
  for (const auto& part : one.told) CHECK(contains(result.err, part));
  if (one.exit != 0) {
    CHECK(result.err.starts_with("emberfold: "));
    const auto last = result.err.rfind("emberfold: ");
    CHECK(std::ranges::count(result.err.substr(last), '\n') == 1);
    CHECK(snapshot(in.temp.path()) == before);
    return;
  }
  CHECK((result.err.empty() || result.err.starts_with("emberfold: warning: ")));
  if (one.told.empty() && contains(one.arguments.front(), ".avi")) CHECK(result.err.empty());
  CHECK(fs::exists(out / "sketch.jsonl"));
  if (one.out_name == "out") fs::remove_all(out);
  for (const auto& [path, bytes] : before)
    if (!contains(path, one.out_name)) CHECK(bytes_of(path) == bytes);
}

}  // namespace

TEST_CASE("bad and odd inputs: the message, the exit status, and nothing is lost", "[slow]") {
  const Inputs in;
  std::size_t count = 0;
  for (const auto& table : {unreadable(in), misused(in), odd(in)})
    for (const auto& one : table) {
      check_case(in, one);
      ++count;
    }
  CHECK(count >= 60);
}
