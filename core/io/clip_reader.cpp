// SPDX-License-Identifier: Apache-2.0
#include "core/io/clip_reader.hpp"

#include <filesystem>
#include <utility>

#include <opencv2/imgcodecs.hpp>

#include "core/error.hpp"
#include "core/io/frame_decoders.hpp"
#include "core/io/image_files.hpp"
#include "core/io/model_folder.hpp"
#include "core/io/reading/animated_image.hpp"
#include "core/io/reading/image_series.hpp"
#include "core/io/reading/piped_clip.hpp"
#include "core/io/reading/transformed_clip.hpp"
#include "core/io/tiff/axes.hpp"
#include "core/io/tiff_pages.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

namespace {

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

/// Opens images that are the frames of one clip.
std::unique_ptr<FrameDecoder> open_series(std::vector<fs::path> files, const ReadOptions& options,
                                          const core::Warn& warn) {
  refuse_several_series(files);
  refuse_stacks(files);
  if (const auto words = repeated_numbers(files); warn && !words.empty()) warn(words);
  return decode_images(std::move(files), options, warn);
}

std::unique_ptr<FrameDecoder> open_image(const fs::path& path, const ReadOptions& options,
                                         const core::Warn& warn) {
  const Animation animation = read_animation(path);
  if (animation.kind == Animation::Kind::apng) return decode_video(path, options, warn);
  if (animation.kind == Animation::Kind::webp)
    throw core::IoError("cannot read " + path.string() + ": it is an animated WebP of " +
                        std::to_string(animation.frames) +
                        " frames, which no library here decodes; convert it to PNG images, APNG or a video");
  return decode_images({path}, options, warn);
}

/// Refuses a channel of a clip that has only one. The samples and axes of a TIFF may hold others.
void check_channel(const std::string& name, const FrameDecoder& decoder, const ReadOptions& options) {
  if (!options.channel || decoder.info().channels > 1) return;
  if (const fs::path file = first_file(name); is_tiff(file)) {
    const auto pages = read_tiff_pages(file);
    if (pages.front().samples > 1 || (file == name && read_tiff_axes(file, pages).channels > 1)) return;
  }
  throw core::InputError("channel " + std::to_string(*options.channel) + " of " + name +
                         " is asked for, but it is grey and has one channel; leave --channel out");
}

/// Decodes the copy of a pipe's content under the pipe's name.
class PipedDecoder final : public FrameDecoder {
 private:
  template <class Call>
  auto named(const Call& call) const {
    try {
      return call();
    } catch (const core::IoError& error) {
      throw core::IoError(replaced(error.what(), path_, name_));
    } catch (const core::InputError& error) {
      throw core::InputError(replaced(error.what(), path_, name_));
    }
  }

 public:
  PipedDecoder(const std::string& name, const ReadOptions& options, const core::Warn& warn)
      : name_(name == "-" ? "standard input" : name), pipe_(name), path_(pipe_.path().string()) {
    const core::Warn renamed = [this, warn](const std::string& text) {
      if (warn) warn(replaced(text, path_, name_));
    };
    named([&] {
      if (is_tiff(path_))
        decoder_ = decode_tiff(path_, options, renamed);
      else if (cv::haveImageReader(path_))
        decoder_ = open_image(path_, options, renamed);
      else
        decoder_ = decode_video(path_, options, renamed);
      check_channel(path_, *decoder_, options);
      return 0;
    });
  }
  [[nodiscard]] const core::ClipInfo& info() const override { return decoder_->info(); }
  cv::Mat next() override {
    return named([&] { return decoder_->next(); });
  }
  bool skip() override {
    return named([&] { return decoder_->skip(); });
  }
  void rewind() override {
    named([&] { return decoder_->rewind(), 0; });
  }

 private:
  std::string name_;
  PipedClip pipe_;
  std::string path_;
  std::unique_ptr<FrameDecoder> decoder_;
};

std::unique_ptr<FrameDecoder> open_decoder(const std::string& name, const ReadOptions& options,
                                           const core::Warn& warn) {
  if (is_piped(name)) return std::make_unique<PipedDecoder>(name, options, warn);
  const fs::path path(name);
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_directory(status))
    if (const auto format = model_format(path))
      throw core::IoError(name + " is no clip but " + about_model(*format));
  if (fs::is_directory(status)) return open_series(list_images(path), options, warn);
  if (!fs::exists(status)) {
    if (is_pattern(path)) return open_series(match_images(path), options, warn);
    throw core::IoError(name.empty() ? "the clip's name is empty"
                                     : "cannot read " + name + ": " +
                                           (error && error != std::errc::no_such_file_or_directory
                                                ? error.message()
                                                : "there is no such file or folder"));
  }
  if (is_tiff(path)) return decode_tiff(path, options, warn);
  if (is_image_name(path)) return open_image(path, options, warn);
  return decode_video(path, options, warn);
}

}  // namespace

std::unique_ptr<core::FrameSource> open_video(const std::string& name, const ReadOptions& options,
                                              const core::Warn& warn) {
  options.validate();
  ReadOptions decoding = options;
  if (options.channel) decoding.grey = false;  // the channel is picked from the colours
  auto decoder = open_decoder(name, decoding, warn);
  if (!is_piped(name)) check_channel(name, *decoder, options);
  return transform_clip(name == "-" ? "standard input" : name, std::move(decoder), options, warn);
}

std::unique_ptr<core::FrameSource> open_clip(core::Clip clip, const std::string& name,
                                             const ReadOptions& options, const core::Warn& warn) {
  options.validate();
  refuse_slices(name, options);
  auto decoder = decode_clip(std::move(clip));
  check_channel(name, *decoder, options);
  return transform_clip(name, std::move(decoder), options, warn);
}

}  // namespace emberfold::io
