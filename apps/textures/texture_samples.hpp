// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/cli/command.hpp"
#include "dytex/distances/window_spectra.hpp"
#include "dytex/linear_dynamic_texture.hpp"

// Reads labelled textures from a folder with one subfolder per class.
namespace emberfold::apps {

/// Holds the settings for cutting clips into samples and learning them.
struct SampleOptions {
  int columns = 1, rows = 1;  ///< 1 … 64: blocks per frame
  int pieces = 1;             ///< 1 … 64: parts of equal length per clip
  int components = 20;        ///< ≥ 1, of each learned model
  io::ReadOptions reading;

  /// Throws core::InputError naming the field, its value and what is allowed.
  void validate() const;
};

/// A clip, or the folder of a model learned from one.
struct LabelledClip {
  std::filesystem::path path;
  std::size_t label = 0;  ///< index of its class
  bool model = false;
};

/// The classes and their clips.
struct LabelledClips {
  std::vector<std::string> classes;
  std::vector<LabelledClip> clips;  ///< class by class, in natural order
};

/// Lists FOLDER/CLASS/CLIP: videos, folders of images and model folders. Warns of other files and skips them.
/// Throws core::IoError where there are fewer than two classes, or a class has no clip.
LabelledClips list_labelled(const std::filesystem::path& folder, const core::Warn& warn);

/// One sample of a clip.
struct TextureSample {
  std::string name;
  std::size_t clip = 0;  ///< index in LabelledClips::clips
};
/// The samples and their models.
struct TextureSamples {
  std::vector<TextureSample> samples;
  std::vector<dytex::LinearDynamicTexture> textures;  ///< one for each
  /// By sample, of all pixels of its cell, in frames reduced to 320 px if longer; empty if any sample is a
  /// model folder, since windows of clips and of models are not comparable.
  std::vector<dytex::WindowSpectrum> windows;
};

/// Learns a model of every block and piece of every clip; a model folder is one sample. All blocks have the
/// size of the smallest cell of any clip, or of the models where there are any, and are centred in their
/// cell. Keeps one clip in memory at a time. Throws core::IoError where sizes or channels do not fit.
TextureSamples learn_samples(const LabelledClips& labelled, const SampleOptions& options,
                             const Session& session, const core::Warn& warn);

}  // namespace emberfold::apps
