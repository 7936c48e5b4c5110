// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dytex/learn.hpp"
#include "graph/matching/match.hpp"
#include "mcmc/model/motion_model.hpp"
#include "pipeline/sketch_clip.hpp"
#include "sketch/extract.hpp"
#include "sketch/inpainting/fill.hpp"
#include "sketch/rendering/sharpening.hpp"

namespace emberfold::pipeline {

/// The fewest frames that a comparison takes.
constexpr int kFewestFrames = 8;

struct CompareOptions {
  sketch::ExtractOptions sketch;
  graph::MatchOptions match;
  sketch::FillOptions fill;
  dytex::LearnOptions learn;  ///< at most a third of the frames as components: more fit a short clip's chance
  double learn_share = 0.5;   ///< of the clip, from its beginning, that models learn from; (0, 1]
  int steps = 8;              ///< frames that are foretold at most, 1 … 64
  int frames = 0;             ///< of each synthesized clip; 0: as many as the source has
  bool hybrid = true;         ///< compare the hybrid of motion model and dynamic texture, too
  bool star = true;           ///< and spatio-temporal auto-regression
  bool curve = false;         ///< quality against model size, too
  bool strokes = true;        ///< find strokes in the synthesized clips and measure them

  /// InputError naming the field, its value and what is allowed.
  void validate() const;
};

/// What the caller has already made of the whole clip; what is null is made here.
struct KnownModels {
  const SketchedClip* sketched = nullptr;  ///< as extracted: match() steadies a sketch with frames to come
  /// Models of the whole clip, drawn from instead of those of its first part.
  const mcmc::MotionModel* motion_model = nullptr;
  const sketch::Sharpening* sharpening = nullptr;  ///< with motion_model
  const dytex::LinearDynamicTexture* texture = nullptr;
};

}  // namespace emberfold::pipeline
