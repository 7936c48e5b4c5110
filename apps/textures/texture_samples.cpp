// SPDX-License-Identifier: Apache-2.0
#include "apps/textures/texture_samples.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <opencv2/imgproc.hpp>

#include "apps/builtin/open_clip.hpp"
#include "apps/cli/interrupt.hpp"
#include "apps/textures/texture_folder.hpp"
#include "core/io/clip_reader.hpp"
#include "core/io/files.hpp"
#include "core/io/image_files.hpp"
#include "core/io/model_folder.hpp"
#include "core/text/check_range.hpp"
#include "dytex/learn.hpp"

namespace emberfold::apps {

namespace fs = std::filesystem;

namespace {

constexpr double kWindowsSide = 320;  // px, the longer side of the frames whose windows are described

std::vector<fs::path> entries(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> found;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (!entry->path().filename().string().starts_with('.')) found.push_back(entry->path());
  if (error) throw core::IoError("cannot read the folder " + folder.string() + ": " + error.message());
  std::ranges::sort(found, [](const fs::path& a, const fs::path& b) {
    return io::natural_less(a.filename().string(), b.filename().string());
  });
  return found;
}

bool holds_images(const fs::path& folder) {
  return std::ranges::any_of(entries(folder), [](const fs::path& path) { return io::is_image_name(path); });
}

std::string size_text(int width, int height, int channels) {
  return std::to_string(width) + " x " + std::to_string(height) + (channels == 3 ? " in colour" : " in grey");
}

// The common size and channels of the samples.
struct Shape {
  int width = 0, height = 0, channels = 0;
  std::string decided_by;
};

void join(std::optional<Shape>& shape, const Shape& next, bool exact) {
  if (!shape) {
    shape = next;
    return;
  }
  if (shape->channels != next.channels)
    throw core::IoError(next.decided_by + " is " + (next.channels == 3 ? "in colour" : "in grey") + ", " +
                        shape->decided_by + " is not; give --grey (models cannot be changed)");
  if (exact && (shape->width != next.width || shape->height != next.height))
    throw core::IoError(next.decided_by + " has frames of " +
                        size_text(next.width, next.height, next.channels) + ", " + shape->decided_by +
                        " of " + size_text(shape->width, shape->height, shape->channels) +
                        "; models of different frames cannot be compared");
  if (exact) return;
  if (next.width < shape->width || next.height < shape->height) shape->decided_by = next.decided_by;
  shape->width = std::min(shape->width, next.width);
  shape->height = std::min(shape->height, next.height);
}

// Returns the size of a block: that of the models, or of the smallest cell of any clip.
Shape common_shape(const LabelledClips& labelled, const SampleOptions& options, const core::Warn& warn) {
  std::optional<Shape> models, cells;
  for (const auto& clip : labelled.clips) {
    const std::string name = clip.path.string();
    if (clip.model) {
      const auto info = read_texture(name).info;
      join(models, {info.width, info.height, info.channels, name}, true);
    } else {
      const auto info = open_held_clip(name, options.reading, warn)->info();
      join(cells, {info.width / options.columns, info.height / options.rows, info.channels, name}, false);
    }
  }
  if (!models || !cells) {
    Shape shape = models ? *models : *cells;
    if (shape.width < 1 || shape.height < 1)
      throw core::IoError(shape.decided_by + " is too small to be cut into so many blocks");
    return shape;
  }
  if (cells->channels != models->channels || cells->width < models->width || cells->height < models->height)
    throw core::IoError(cells->decided_by + " has blocks of " +
                        size_text(cells->width, cells->height, cells->channels) + ", the model " +
                        models->decided_by + " needs " +
                        size_text(models->width, models->height, models->channels));
  return *models;
}

class Learner {
 public:
  Learner(const SampleOptions& options, const Shape& shape, const Session& session, TextureSamples& samples)
      : options_(options), shape_(shape), session_(session), samples_(samples) {}

  void take(const LabelledClip& labelled, std::size_t index, const core::Clip& clip) {
    const std::size_t frames = clip.frames.size();
    const auto pieces = static_cast<std::size_t>(options_.pieces);
    for (std::size_t piece = 0; piece < pieces; ++piece) {
      const std::size_t first = frames * piece / pieces, last = frames * (piece + 1) / pieces;
      check_length(labelled, static_cast<int>(last - first));
      for (int row = 0; row < options_.rows; ++row)
        for (int column = 0; column < options_.columns; ++column) {
          session_.check_stop();
          samples_.samples.push_back({sample_name(labelled, row, column, piece), index});
          samples_.textures.push_back(learn(cut_block(clip, block(clip, row, column), first, last)));
          samples_.windows.push_back(describe(clip, cell(clip, row, column), first, last));
        }
    }
  }

 private:
  void check_length(const LabelledClip& labelled, int frames) const {
    if (options_.components + 2 <= frames) return;
    throw Misuse("--components is " + std::to_string(options_.components) + "; a piece of " +
                 labelled.path.string() + " has " + std::to_string(frames) + " frames, so allowed is 1 to " +
                 std::to_string(frames - 2));
  }
  // Returns the part of a frame that belongs to the block.
  [[nodiscard]] cv::Rect cell(const core::Clip& clip, int row, int column) const {
    const cv::Point from(clip.info.width * column / options_.columns, clip.info.height * row / options_.rows);
    const cv::Point to(clip.info.width * (column + 1) / options_.columns,
                       clip.info.height * (row + 1) / options_.rows);
    return {from, to};
  }
  // Returns the centre of cell(), in the common block size.
  [[nodiscard]] cv::Rect block(const core::Clip& clip, int row, int column) const {
    const cv::Rect whole = cell(clip, row, column);
    return {whole.x + (whole.width - shape_.width) / 2, whole.y + (whole.height - shape_.height) / 2,
            shape_.width, shape_.height};
  }
  [[nodiscard]] core::Clip cut_block(const core::Clip& clip, const cv::Rect& block, std::size_t first,
                                     std::size_t last) const {
    core::Clip part{clip.info, {}};
    part.info.width = block.width;
    part.info.height = block.height;
    part.info.frames = static_cast<std::int64_t>(last - first);
    for (std::size_t t = first; t < last; ++t) part.frames.push_back(clip.frames[t](block).clone());
    return part;
  }
  [[nodiscard]] std::string sample_name(const LabelledClip& labelled, int row, int column,
                                        std::size_t piece) const {
    std::string name =
        labelled.path.parent_path().filename().string() + "/" + labelled.path.filename().string();
    if (options_.columns * options_.rows > 1)
      name += ":" + std::to_string(column) + "," + std::to_string(row);
    if (options_.pieces > 1) name += "@" + std::to_string(piece);
    return name;
  }
  [[nodiscard]] dytex::LinearDynamicTexture learn(const core::Clip& part) const {
    dytex::LearnOptions options;
    options.components = options_.components;
    core::ClipSource source(part);
    auto learned = dytex::learn(source, options, session_.context.with_progress({}));
    return std::move(learned.texture);
  }
  // Reduces large frames, so that windows of all clips show about the same part of their scene.
  [[nodiscard]] dytex::WindowSpectrum describe(const core::Clip& clip, const cv::Rect& part,
                                               std::size_t first, std::size_t last) const {
    const double scale = std::min(1.0, kWindowsSide / std::max(clip.info.width, clip.info.height));
    const cv::Size size(std::max(1, static_cast<int>(std::lround(scale * part.width))),
                        std::max(1, static_cast<int>(std::lround(scale * part.height))));
    dytex::WindowEnergies energies(size);
    for (std::size_t t = first; t < last; ++t) {
      session_.check_stop();
      cv::Mat levels = core::luma(clip.frames[t](part), clip.info);
      if (size != part.size()) cv::resize(levels, levels, size, 0, 0, cv::INTER_AREA);
      energies.add(levels);
    }
    return energies.spectrum();
  }

  const SampleOptions& options_;
  const Shape& shape_;
  const Session& session_;
  TextureSamples& samples_;
};

}  // namespace

void SampleOptions::validate() const {
  core::check_range("SampleOptions.columns", columns, 1, 64);
  core::check_range("SampleOptions.rows", rows, 1, 64);
  core::check_range("SampleOptions.pieces", pieces, 1, 64);
  core::check_range("SampleOptions.components", components, 1, 1000);
  reading.validate();
}

LabelledClips list_labelled(const fs::path& folder, const core::Warn& warn) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored))
    throw core::IoError(folder.string() + " is no folder; give one that holds a folder for each class");
  LabelledClips labelled;
  for (const auto& place : entries(folder)) {
    if (!fs::is_directory(place, ignored)) {
      warn(place.string() + " is passed over: it is no folder of a class");
      continue;
    }
    const std::size_t label = labelled.classes.size(), before = labelled.clips.size();
    for (const auto& path : entries(place)) {
      const bool is_folder = fs::is_directory(path, ignored);
      if (!is_folder && io::is_image_name(path))
        throw core::IoError(place.string() + " holds images itself; a class holds a folder for each clip: " +
                            (place / "CLIP" / path.filename()).string());
      const bool model = is_folder && io::model_format(path) == io::kTextureFormat;
      if (model || (is_folder ? holds_images(path) : io::is_video_name(path)))
        labelled.clips.push_back({path, label, model});
      else
        warn(path.string() + " is passed over: it is no clip and no linear dynamic texture");
    }
    if (labelled.clips.size() == before)
      throw core::IoError("the class " + place.string() + " has no clip and no linear dynamic texture");
    if (labelled.clips.size() == before + 1)
      warn("the class " + place.filename().string() +
           " has one clip alone: while it is asked for, there is none to know it by");
    labelled.classes.push_back(place.filename().string());
  }
  if (labelled.classes.size() < 2)
    throw core::IoError(folder.string() + " holds " + std::to_string(labelled.classes.size()) +
                        (labelled.classes.size() == 1 ? " class" : " classes") + "; two or more are needed");
  return labelled;
}

TextureSamples learn_samples(const LabelledClips& labelled, const SampleOptions& options,
                             const Session& session, const core::Warn& warn) {
  const Shape shape = common_shape(labelled, options, warn);
  TextureSamples samples;
  Learner learner(options, shape, session, samples);
  for (std::size_t i = 0; i < labelled.clips.size(); ++i) {
    session.check_stop();
    session.context.report("learn", static_cast<double>(i) / static_cast<double>(labelled.clips.size()));
    const auto& clip = labelled.clips[i];
    if (clip.model) {
      samples.samples.push_back(
          {clip.path.parent_path().filename().string() + "/" + clip.path.filename().string(), i});
      samples.textures.push_back(read_texture(clip.path.string()));
    } else {
      learner.take(clip, i, core::read_all(*open_held_clip(clip.path.string(), options.reading, {})));
    }
  }
  if (samples.windows.size() < samples.textures.size()) samples.windows.clear();
  return samples;
}

}  // namespace emberfold::apps
