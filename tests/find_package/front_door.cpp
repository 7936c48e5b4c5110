// SPDX-License-Identifier: Apache-2.0
// Analyses a video, writes its model's folder and draws a new clip from it: what `emberfold analyze` and
// `emberfold synth` do. Arguments: CLIP MODEL_FOLDER NEW_CLIP.
#include "core/io/clip_reader.hpp"
#include "core/io/clip_writer.hpp"
#include "core/io/model_folder.hpp"
#include "pipeline/analyze.hpp"
#include "pipeline/clip_synthesis.hpp"

using namespace emberfold;

int main(int, char** arguments) {
  const auto clip = io::open_video(arguments[1]);
  const auto result = pipeline::analyze(*clip);
  io::write_model(arguments[2], to_archive(result.model));
  pipeline::ClipSynthesis synthesis(result.model, {.seed = 1});
  io::write_video(arguments[3], synthesis, 60);
}
