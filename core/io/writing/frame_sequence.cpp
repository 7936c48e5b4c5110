// SPDX-License-Identifier: Apache-2.0
#include "core/io/writing/frame_sequence.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/error.hpp"
#include "core/io/image_files.hpp"
#include "core/io/linear_light.hpp"
#include "core/io/scratch.hpp"
#include "core/io/writing/fitted_frame.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

namespace {

/// Enables EXR in OpenCV, which looks at this only once.
void enable_exr() {
  static const bool once = [] {
    ::setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 0);  // NOLINT(concurrency-mt-unsafe): once
    return true;
  }();
  static_cast<void>(once);
}

/// Returns the position of a pattern's only number; nothing where it has none, several, or other wildcards.
std::optional<std::size_t> only_number(const std::string& pattern) {
  constexpr std::size_t kMostDigits = 9;
  const auto at = pattern.find('%');
  if (at == std::string::npos || pattern.find_first_of("*?") != std::string::npos ||
      pattern.find('%', at + 1) != std::string::npos)
    return std::nullopt;
  const auto number = pattern_number(std::string_view(pattern).substr(at));
  const bool is_plain = number && number->length == 2;
  return is_plain || (number && number->digits >= 1 && number->digits <= kMostDigits) ? std::optional(at)
                                                                                      : std::nullopt;
}

std::string name_of(const std::string& pattern, long long frame) {
  const std::size_t at = *only_number(pattern);
  const PatternNumber number = *pattern_number(std::string_view(pattern).substr(at));
  std::string digits = std::to_string(frame);
  if (digits.size() < number.digits) digits.insert(0, number.digits - digits.size(), '0');
  return std::string(pattern).replace(at, number.length, digits);
}

fs::path absolute_folder(const fs::path& path) {
  const fs::path folder = fs::absolute(path).lexically_normal();
  return folder.has_filename() ? folder : folder.parent_path();  // a slash at the end
}

/// Refuses a target that is, or holds, anything not ours to replace.
void check_replaceable(const fs::path& folder, const std::string& pattern) {
  std::error_code error;
  const fs::file_status status = fs::status(folder, error);
  if (!fs::exists(status)) return;
  if (!fs::is_directory(status)) refuse_to_write(folder, "a file has this name");
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (!fits_pattern(pattern, entry->path().filename().string()))
      refuse_to_write(folder, "this folder holds other things than frames (" +
                                  entry->path().filename().string() + "); give the name of a new one");
  if (error) refuse_to_write(folder, error.message());
}

/// Removes a folder of frames; if anything else is in it, that and the folder stay.
void remove_frames(const fs::path& folder, const std::string& pattern) {
  std::error_code ignored;
  std::vector<fs::path> frames;
  for (fs::directory_iterator entry(folder, ignored), end; !ignored && entry != end; entry.increment(ignored))
    if (fits_pattern(pattern, entry->path().filename().string())) frames.push_back(entry->path());
  for (const fs::path& frame : frames) fs::remove(frame, ignored);
  fs::remove(folder, ignored);
}

class SequenceWriter final : public VideoWriter {
 public:
  SequenceWriter(SequenceName name, cv::Size size, bool colour)
      : path_(std::move(name.folder)),
        pattern_(std::move(name.pattern)),
        part_(scratch_path(path_.parent_path())),
        exr_(fs::path(pattern_).extension() == ".exr"),
        format_{size, colour, exr_ ? "8 or 16 bits or floats" : "8 or 16 bits", true, exr_, true} {
    if (exr_) enable_exr();
    check_replaceable(path_, pattern_);
    std::error_code error;
    fs::create_directory(part_, error);
    if (error) refuse_to_write(path_, error.message());
  }

  ~SequenceWriter() override {
    if (!finished_) remove_frames(part_, pattern_);
  }

  void write(const cv::Mat& frame) override {
    if (finished_) throw core::InputError(path_.string() + ": the clip is finished");
    const cv::Mat whole = fitted_frame(frame, format_, path_);
    if (frames_ == 0) type_ = whole.type();
    if (whole.type() != type_)
      throw core::InputError(path_.string() + ": frames of different depths or channels do not mix");
    const auto bytes = encoded(whole);
    const std::string name = name_of(pattern_, frames_);
    errno = 0;
    std::ofstream out(part_ / name, std::ios::binary | std::ios::trunc);
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (!out)
      refuse_to_write(path_, errno != 0 ? std::generic_category().message(errno) : "the disk may be full");
    ++frames_;
  }

  void finish() override {
    if (finished_) throw core::InputError(path_.string() + ": the clip is finished");
    if (frames_ == 0) throw core::InputError(path_.string() + ": a clip needs at least one frame");
    check_replaceable(path_, pattern_);  // once more: it may have changed since
    const fs::path old = scratch_path(path_.parent_path());
    std::error_code error;
    const bool replaces = fs::exists(path_, error);
    if (replaces) {
      fs::rename(path_, old, error);
      if (error) refuse_to_write(path_, error.message());
    }
    fs::rename(part_, path_, error);
    if (error) {
      std::error_code ignored;
      if (replaces) fs::rename(old, path_, ignored);
      refuse_to_write(path_, error.message());
    }
    finished_ = true;
    if (replaces) remove_frames(old, pattern_);
  }

 private:
  [[nodiscard]] std::vector<unsigned char> encoded(const cv::Mat& frame) const {
    std::vector<unsigned char> bytes;
    const std::vector<int> half = {cv::IMWRITE_EXR_TYPE, cv::IMWRITE_EXR_TYPE_HALF};
    const bool done =
        exr_ ? cv::imencode(".exr", frame.depth() == CV_32F ? frame : to_linear_light(frame), bytes, half)
             : cv::imencode(".png", frame, bytes);
    if (!done) refuse_to_write(path_, std::string("a frame cannot be encoded as ") + (exr_ ? "EXR" : "PNG"));
    return bytes;
  }

  fs::path path_;
  std::string pattern_;
  fs::path part_;
  bool exr_;
  FrameFormat format_;
  int type_ = CV_8UC1;
  long long frames_ = 0;
  bool finished_ = false;
};

}  // namespace

std::optional<SequenceName> sequence_name(const fs::path& path) {
  if (!is_pattern(path)) {
    if (path.has_extension()) return std::nullopt;
    return SequenceName{absolute_folder(path), "frame_%05d.png"};
  }
  const std::string pattern = path.filename().string();
  const auto refuse = [&](const std::string& what) {
    throw core::InputError("the frames' name " + pattern + " " + what);
  };
  const std::string extension = path.extension().string();
  if (extension != ".png" && extension != ".exr") refuse("ends in neither .png nor .exr");
  if (!only_number(pattern)) refuse("needs one number such as %05d, and no *, ? or other %");
  if (!path.has_parent_path()) refuse("needs a folder before it, such as frames/" + pattern);
  return SequenceName{absolute_folder(path.parent_path()), pattern};
}

std::unique_ptr<VideoWriter> create_sequence(SequenceName name, cv::Size size, bool colour) {
  return std::make_unique<SequenceWriter>(std::move(name), size, colour);
}

}  // namespace emberfold::io
