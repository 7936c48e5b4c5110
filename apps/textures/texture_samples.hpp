// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/cli/command.hpp"
#include "dytex/linear_dynamic_texture.hpp"

// Textures that are to be told apart, from a folder with a folder for each class.
namespace emberfold::apps {

struct SampleOptions {
  int columns = 1, rows = 1;  ///< 1 … 64: blocks into which every frame is cut
  int pieces = 1;             ///< 1 … 64: parts of equal length into which the clip is cut
  int components = 20;        ///< ≥ 1, of each model that is learned
  io::ReadOptions reading;

  /// core::InputError naming the field, its value and what is allowed.
  void validate() const;
};

/// A clip, or a model that was learned from one.
struct LabelledClip {
  std::filesystem::path path;
  std::size_t label = 0;  ///< index of its class
  bool model = false;
};

struct LabelledClips {
  std::vector<std::string> classes;
  std::vector<LabelledClip> clips;  ///< class by class, in natural order
};

/// FOLDER/CLASS/CLIP: videos, folders of images and model folders. What is none of them is passed over with a
/// warning. core::IoError where there are fewer than two classes, or a class has no clip.
LabelledClips list_labelled(const std::filesystem::path& folder, const core::Warn& warn);

struct TextureSample {
  std::string name;
  std::size_t clip = 0;  ///< index in LabelledClips::clips
};
struct TextureSamples {
  std::vector<TextureSample> samples;
  std::vector<dytex::LinearDynamicTexture> textures;  ///< one for each
};

/// Learns a model of every block and piece of every clip; a model folder is one sample. All blocks have the
/// size of the smallest cell of any clip (or of the models, where there are any), cut from the middle of
/// their cell. Holds one clip at a time. core::IoError where sizes or channels do not fit.
TextureSamples learn_samples(const LabelledClips& labelled, const SampleOptions& options,
                             const Session& session, const core::Warn& warn);

}  // namespace emberfold::apps
