// SPDX-License-Identifier: Apache-2.0
// Prints what speaks for each event that is read from a clip, one line each; fit_event_weights.py reads it.
#include <exception>
#include <iostream>

#include "core/io/clip_reader.hpp"
#include "graph/matching/match.hpp"
#include "pipeline/inference/event_evidence.hpp"
#include "pipeline/inference/lasting_patches.hpp"
#include "pipeline/sketch_clip.hpp"

using namespace emberfold;

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::cerr << "usage: event_evidence CLIP\n";
    return 2;
  }
  const auto clip = io::open_video(argv[1]);
  const auto sketch = pipeline::sketch_clip(*clip, pipeline::kFollowedSketch, {}).sketch;
  const auto motion = graph::match(pipeline::add_lasting_patches(*clip, sketch), {});
  std::cout << "frame,type,x,y,log_factor,of_stroke,since,until,contrast\n";
  for (const auto& [event, evidence] : pipeline::weigh_events(*clip, motion))
    std::cout << event.frame << ',' << graph::name(event.type) << ',' << event.position.x << ','
              << event.position.y << ',' << evidence.log_factor << ',' << evidence.of_stroke << ','
              << evidence.since << ',' << evidence.until << ',' << evidence.contrast << '\n';
  return 0;
} catch (const std::exception& error) {
  std::cerr << "event_evidence: " << error.what() << '\n';
  return 1;
}
