// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <type_traits>

#include "core/io/clip_reader.hpp"
#include "dytex/learn.hpp"
#include "graph/events/event_score.hpp"
#include "graph/matching/match.hpp"
#include "graph/morphing/morph.hpp"
#include "mcmc/sampler/infer.hpp"
#include "pipeline/calibration.hpp"
#include "pipeline/readings.hpp"
#include "sketch/extract.hpp"
#include "sketch/inpainting/fill.hpp"

// Visits the fields of the options structs that --set offers: visit(name, value, unit, meaning). The command
// line and summary.json are both made from here; defaults and ranges stay in the structs.
namespace emberfold::apps {

template <class Given, class Options>
concept MaybeConst = std::same_as<std::remove_const_t<Given>, Options>;

void visit_fields(MaybeConst<sketch::ExtractOptions> auto& o, auto&& visit) {
  visit("sensitivity", o.sensitivity, "S", "Draw what is sure (0) up to all there may be (1)");
  visit("finest_scale", o.finest_scale, "PX", "SD of the finest Gaussian in which creases are detected");
  visit("scales", o.scales, "N", "Number of scales, each sqrt(2) times the one before");
  visit("significance", o.significance, "SD",
        "Start a curve where the response exceeds this multiple of the noise");
  visit("hysteresis", o.hysteresis, "SHARE", "Continue a curve down to this share of that response");
  visit("min_contrast", o.min_contrast, "LEVELS", "Leave out fainter strokes (grey levels of 255)");
  visit("min_length", o.min_length, "PX", "Leave out shorter curves that end freely");
  visit("min_evidence", o.min_evidence, "SD", "Leave out curves of less significance in total");
  visit("spacing", o.spacing, "PX", "Distance of neighbouring patches along a curve");
  visit("steady", o.steady, "", "Make the sketches of a clip agree with those before and after");
  visit("edges", o.edges, "", "Detect step edges beside ridges and valleys");
  visit("boundaries", o.boundaries, "", "Sketch the boundaries of things in photographs instead");
  visit("colour", o.colour, "", "Detect structure in two axes of colour too, not only in luma");
  visit("blobs", o.blobs, "", "Add blobs where the fill between strokes leaves more than noise");
  visit("budget", o.budget, "SHARE",
        "Keep the patches that gain most on this share of the frame; 0: all that pay");
  visit("tile", o.tile, "PX", "Sketch larger frames in parts of at most this side");
}

void visit_fields(MaybeConst<graph::MatchOptions> auto& o, auto&& visit) {
  visit("max_motion", o.max_motion, "PX", "Link nothing farther than this from its expected place");
  visit("sigma_across", o.sigma_across, "PX", "Spread of a patch across its curve between two frames");
  visit("sigma_along", o.sigma_along, "PX", "Spread of a patch along its curve");
  visit("sigma_angle", o.sigma_angle, "RAD", "Spread of a patch's orientation");
  visit("sigma_contrast", o.sigma_contrast, "LOG", "Spread of the logarithm of a patch's contrast");
  visit("sigma_count", o.sigma_count, "LOG", "Spread of the logarithm of a stroke's number of patches");
  visit("sigma_shape", o.sigma_shape, "PX", "Spread of a stroke's shape");
  visit("sigma_degree", o.sigma_degree, "N", "Spread of a stroke's vertex degrees");
  visit("flicker", o.flicker, "FRAMES", "Remove what comes and goes within this many frames; 0: nothing");
}

void visit_fields(MaybeConst<graph::MorphOptions> auto& o, auto&& visit) {
  visit("frames", o.frames, "N", "Draw this many frames of a morph, both ends included");
  visit("farthest", o.farthest, "PX", "Let strokes fade rather than move so far");
  visit("level_weight", o.level_weight, "PX", "Count a change by one grey level as a motion by so much");
}

void visit_fields(MaybeConst<pipeline::StartOptions> auto& o, auto&& visit) {
  visit("chains", o.chains, "N",
        "Number of sampler chains, started from the clip forwards, backwards, with noise");
  visit("perturb", o.perturb, "LEVELS", "SD of the noise that is added to the clip for some chains");
}

void visit_fields(MaybeConst<pipeline::CalibrateOptions> auto& o, auto&& visit) {
  visit("calibrate", o.calibrate, "ROUNDS",
        "Draw from the model, analyse the clip and correct the rates; 0: never");
}

void visit_fields(MaybeConst<mcmc::InferOptions> auto& o, auto&& visit) {
  visit("sweeps", o.sweeps, "N", "Sweeps of each chain after burn-in");
  visit("burn_in", o.burn_in, "N", "Sweeps of each chain before states are kept, while it adapts");
  visit("samples", o.samples, "N", "Number of states that each chain keeps");
  visit("proposals", o.proposals, "N", "Proposed moves for each patch in a sweep");
  visit("from_nothing", o.from_nothing, "",
        "Start one more chain without any patch, as a judge of the others");
}

void visit_fields(MaybeConst<sketch::FillOptions> auto& o, auto&& visit) {
  visit("tolerance", o.tolerance, "LEVELS", "Stop the solver at this estimated largest error (grey levels)");
  visit("max_iterations", o.max_iterations, "N", "Stop the solver after this many iterations");
}

// `dytex learn` has options of its own for the other fields.
void visit_fields(MaybeConst<dytex::LearnOptions> auto& o, auto&& visit) {
  visit("components", o.components, "N", "Number of components of the linear dynamic texture");
}

void visit_fields(MaybeConst<io::ReadOptions> auto& o, auto&& visit) {
  visit("scale", o.scale, "FACTOR", "Resize the frames by this factor");
}

void visit_fields(MaybeConst<graph::ScoreOptions> auto& o, auto&& visit) {
  visit("frames", o.frames, "N", "Count a true event at most this many frames away as a hit");
  visit("radius", o.radius, "PX", "Count a true event at most this far away as a hit");
}

}  // namespace emberfold::apps
