// SPDX-License-Identifier: Apache-2.0
// Analyses a video, writes its model's folder, draws a new clip from it and compares both: what `emberfold
// analyze`, `synth` and `compare` do. Arguments: CLIP MODEL_FOLDER NEW_CLIP.
#include <cstdio>

#include "core/io/clip_reader.hpp"
#include "core/io/clip_writer.hpp"
#include "core/io/model_folder.hpp"
#include "pipeline/analyze.hpp"
#include "pipeline/clip_synthesis.hpp"
#include "pipeline/compare.hpp"

using namespace emberfold;

int main(int, char** arguments) {
  const auto clip = io::open_video(arguments[1]);
  const auto result = pipeline::analyze(*clip);
  io::write_model(arguments[2], to_archive(result.model));
  pipeline::ClipSynthesis synthesis(result.model, {.seed = 1});
  io::write_video(arguments[3], synthesis, 60);
  const auto report = pipeline::compare(*clip, *io::open_video(arguments[3]));

  const auto& distances = report.distances;
  std::printf("temporal_db %.9g\nradial_db %.9g\npatterns %.9g\nflow_px %.9g\nti %.9g\nstroke_events %.9g\n",
              distances.pixels.temporal_db, distances.pixels.radial_db, distances.pixels.patterns,
              distances.pixels.flow_px, distances.pixels.ti, distances.strokes->event_rates);
}
