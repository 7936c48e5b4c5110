// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <type_traits>

#include "core/io/clip_reader.hpp"
#include "dytex/learn.hpp"
#include "graph/events/event_score.hpp"
#include "graph/matching/match.hpp"
#include "mcmc/sampler/infer.hpp"
#include "pipeline/calibration.hpp"
#include "pipeline/readings.hpp"
#include "sketch/extract.hpp"
#include "sketch/inpainting/fill.hpp"

// The fields of the options structs that the command line offers: visit(name, value, unit, what it does). The
// command line and summary.json are both made from here; defaults and ranges stay in the structs.
namespace emberfold::apps {

template <class Options, class Visit>
requires std::same_as<std::remove_const_t<Options>, sketch::ExtractOptions>
void visit_fields(Options& o, Visit&& visit) {
  visit("finest_scale", o.finest_scale, "PX", "SD of the finest Gaussian that creases are sought with");
  visit("scales", o.scales, "N", "How many scales, each sqrt(2) above the one before");
  visit("significance", o.significance, "SD",
        "A curve begins where the response is so many SD of the measured ground");
  visit("hysteresis", o.hysteresis, "SHARE", "... and goes on down to this share of that");
  visit("min_contrast", o.min_contrast, "LEVELS", "Fainter strokes are left out (grey levels of 255)");
  visit("min_length", o.min_length, "PX", "Shorter curves that end freely are left out");
  visit("min_evidence", o.min_evidence, "SD", "Curves that are less significant in all are left out");
  visit("spacing", o.spacing, "PX", "From patch to patch along a curve");
  visit("edges", o.edges, "", "Leave step edges out, follow ridges and valleys alone");
  visit("colour", o.colour, "", "Structure from two axes of colour too, not only from luma");
  visit("blobs", o.blobs, "", "Blobs too, where the fill between the strokes leaves more than noise");
  visit("double_ridges", o.double_ridges, "",
        "Two lines that run side by side become one double ridge, where that shortens the code");
  visit("budget", o.budget, "SHARE",
        "The patches that gain most, blobs among them, on so much of the frame; 0: all that pay");
}

template <class Options, class Visit>
requires std::same_as<std::remove_const_t<Options>, graph::MatchOptions>
void visit_fields(Options& o, Visit&& visit) {
  visit("max_motion", o.max_motion, "PX", "Nothing is linked farther than this from where it is expected");
  visit("sigma_across", o.sigma_across, "PX", "Spread of a patch across its curve, from frame to frame");
  visit("sigma_along", o.sigma_along, "PX", "The same along the curve");
  visit("sigma_angle", o.sigma_angle, "RAD", "Spread of its orientation");
  visit("sigma_contrast", o.sigma_contrast, "LOG", "Spread of the logarithm of its contrast");
  visit("sigma_count", o.sigma_count, "LOG", "Spread of the logarithm of a stroke's patch count");
  visit("sigma_shape", o.sigma_shape, "PX", "Spread of a stroke's shape");
  visit("sigma_degree", o.sigma_degree, "N", "Spread of a stroke's degrees");
  visit("flicker", o.flicker, "FRAMES", "What comes and goes within so many frames is noise; 0 keeps all");
}

template <class Options, class Visit>
requires std::same_as<std::remove_const_t<Options>, pipeline::StartOptions>
void visit_fields(Options& o, Visit&& visit) {
  visit("chains", o.chains, "N",
        "From how many readings of the clip, forwards, backwards and in noise, it is sampled");
  visit("perturb", o.perturb, "LEVELS", "SD of the noise that some of them read it in");
}

template <class Options, class Visit>
requires std::same_as<std::remove_const_t<Options>, pipeline::CalibrateOptions>
void visit_fields(Options& o, Visit&& visit) {
  visit("calibrate", o.calibrate, "ROUNDS",
        "Draw from the model, analyse that, correct its rates, so many times; 0: not at all");
}

template <class Options, class Visit>
requires std::same_as<std::remove_const_t<Options>, mcmc::InferOptions>
void visit_fields(Options& o, Visit&& visit) {
  visit("sweeps", o.sweeps, "N", "Sweeps of each chain after burn-in");
  visit("burn_in", o.burn_in, "N", "Sweeps of each chain in which it learns and nothing is kept");
  visit("samples", o.samples, "N", "How many states of each chain are kept");
  visit("proposals", o.proposals, "N", "Moves for every patch in a sweep");
  visit("rungs", o.tempering_levels, "N", "Tempered chains beside each, evidence to the power 1, 1/2, 1/4 ...");
}

template <class Options, class Visit>
requires std::same_as<std::remove_const_t<Options>, sketch::FillOptions>
void visit_fields(Options& o, Visit&& visit) {
  visit("tolerance", o.tolerance, "LEVELS",
        "The fill's solver stops at this estimated largest error (grey levels)");
  visit("max_iterations", o.max_iterations, "N", "... or after so many rounds");
}

// Energy, which may be none, is described by the command itself.
template <class Options, class Visit>
requires std::same_as<std::remove_const_t<Options>, dytex::LearnOptions>
void visit_fields(Options& o, Visit&& visit) {
  visit("components", o.components, "N", "Order: how many components");
}

template <class Options, class Visit>
requires std::same_as<std::remove_const_t<Options>, io::ReadOptions>
void visit_fields(Options& o, Visit&& visit) {
  visit("scale", o.scale, "FACTOR", "Enlarge or reduce the frames first");
}

template <class Options, class Visit>
requires std::same_as<std::remove_const_t<Options>, graph::ScoreOptions>
void visit_fields(Options& o, Visit&& visit) {
  visit("frames", o.frames, "N", "A true event at most so many frames away is a hit");
  visit("radius", o.radius, "PX", "... and at most so far");
}

}  // namespace emberfold::apps
