// SPDX-License-Identifier: Apache-2.0
// Prints what speaks for each event that is read from a clip, one line each; fit_event_weights.py reads it.
// --in-noise: a copy of the clip in noise is read, too, as with 'analyze --quality sure'.
#include <exception>
#include <iostream>
#include <string_view>

#include "core/io/clip_reader.hpp"
#include "pipeline/inference/event_evidence.hpp"
#include "pipeline/inference/event_posterior.hpp"
#include "pipeline/inference/lasting_patches.hpp"
#include "pipeline/readings.hpp"
#include "pipeline/sketch_clip.hpp"

using namespace emberfold;

int main(int argc, char** argv) try {
  const bool in_noise = argc == 3 && std::string_view(argv[2]) == "--in-noise";
  if (argc != 2 && !in_noise) {
    std::cerr << "usage: event_evidence CLIP [--in-noise]\n";
    return 2;
  }
  const auto clip = io::open_video(argv[1]);
  pipeline::StartOptions starts;
  starts.chains = in_noise ? 3 : 1;  // the first of noise is the third
  const auto sketches = pipeline::sketch_starts(*clip, pipeline::kSteadySketch, starts, 1, {});
  const auto sketch = pipeline::add_lasting_patches(*clip, sketches.clip.sketch);
  auto readings = pipeline::match_readings(sketch, graph::match(sketch, {}), {}, false);
  for (const auto& copy : sketches.perturbed)
    pipeline::add_reading_in_noise(readings, pipeline::add_lasting_patches(*clip, copy), {}, false);
  std::cout << "frame,type,x,y,log_factor,of_stroke,agreement,since,until,contrast,next,apart,probability\n";
  const auto weighed = pipeline::weigh_events(*clip, readings);
  const auto probabilities = pipeline::event_probabilities(weighed);
  for (std::size_t k = 0; k < weighed.size(); ++k) {
    const auto& [event, evidence] = weighed[k];
    std::cout << event.frame << ',' << graph::name(event.type) << ',' << event.position.x << ','
              << event.position.y << ',' << evidence.log_factor << ',' << evidence.of_stroke << ','
              << evidence.agreement << ',' << evidence.since << ',' << evidence.until << ','
              << evidence.contrast;
    if (evidence.likeness)
      std::cout << ',' << evidence.likeness->next << ',' << evidence.likeness->apart;
    else
      std::cout << ",,";
    std::cout << ',' << probabilities.of_event[k] << '\n';
  }
  return 0;
} catch (const std::exception& error) {
  std::cerr << "event_evidence: " << error.what() << '\n';
  return 1;
}
