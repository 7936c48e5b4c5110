// SPDX-License-Identifier: Apache-2.0
// Measures the sampler of hidden Markov graphs: how many proposals it evaluates a second and core, where a
// sweep's time goes, how fast event indicators mix, and how its cost grows with the frames of a clip.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <iostream>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <sys/resource.h>

#include "apps/builtin/open_clip.hpp"
#include "core/io/clip_reader.hpp"
#include "core/parallel.hpp"
#include "graph/events/events.hpp"
#include "graph/matching/match.hpp"
#include "mcmc/learning/fit.hpp"
#include "mcmc/sampler/candidate_weights.hpp"
#include "mcmc/sampler/chain.hpp"
#include "mcmc/sampler/diagnostics.hpp"
#include "mcmc/sampler/displacement_gibbs.hpp"
#include "mcmc/sampler/prior.hpp"
#include "mcmc/sampler/sufficient_statistics.hpp"
#include "pipeline/sketch_clip.hpp"

using namespace emberfold;

namespace {

struct Arguments {
  std::vector<std::string> clips;
  int frames = 100, sweeps = 60;
  double proposals = 8;
};

Arguments parse(const std::vector<std::string>& words) {
  Arguments a;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (!word.starts_with("--")) {
      a.clips.push_back(word);
      continue;
    }
    if (word != "--frames" && word != "--sweeps" && word != "--proposals")
      throw std::runtime_error("no option " + word +
                               "; usage: sampler_figures [CLIP …] [--frames N] [--sweeps N] [--proposals X]");
    if (++i == words.size()) throw std::runtime_error(word + " needs a value");
    const double value = std::atof(words[i].c_str());
    if (word == "--frames") a.frames = static_cast<int>(value);
    if (word == "--sweeps") a.sweeps = static_cast<int>(value);
    if (word == "--proposals") a.proposals = value;
  }
  if (a.frames < 10 || a.sweeps < 8 || !(a.proposals > 0))
    throw std::runtime_error("--frames must be 10 or more, --sweeps 8 or more, --proposals above 0");
  if (a.clips.empty()) a.clips = {"builtin:fire"};
  return a;
}

/// Seconds of processor time, as the user's share.
double user_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec) + 1e-6 * static_cast<double>(usage.ru_utime.tv_usec);
}

graph::SketchSequence sketched(const std::string& name, int frames) {
  const auto source = apps::open_clip(name, {}, {});
  graph::SketchSequence result;
  result.width = source->info().width, result.height = source->info().height, result.fps = source->info().fps;
  std::vector<cv::Mat> levels;
  for (int t = 0; t < frames; ++t) {
    const cv::Mat frame = source->next();
    if (frame.empty()) break;
    levels.push_back(core::to_levels(frame, source->info()));
  }
  std::vector<graph::AttributeGraph> graphs(levels.size());
  core::parallel_for(graphs.size(), {}, [&](std::size_t t) { graphs[t] = sketch::extract(levels[t], {}); });
  for (const auto& graph : graphs) result.append(graph);
  return result;
}

/// The clip to and fro, until it has this many frames.
graph::SketchSequence to_and_fro(const graph::SketchSequence& clip, int frames) {
  graph::SketchSequence result;
  result.width = clip.width, result.height = clip.height, result.fps = clip.fps;
  const int last = static_cast<int>(clip.frames.size()) - 1;
  for (int t = 0; t < frames; ++t) {
    const int turn = t % (2 * last);
    result.append(clip.frames[static_cast<std::size_t>(turn <= last ? turn : 2 * last - turn)]);
  }
  return result;
}

/// A chain as `analyze` begins one.
mcmc::Chain begin(const graph::MotionGraph& start, mcmc::SamplerParameters& prior) {
  const auto learned = mcmc::fit(start, {1, false}).model;
  auto states = mcmc::hidden_graphs({&start, 1}, {});
  mcmc::weigh_candidates(states, mcmc::SketchEvidence{});
  mcmc::HiddenGraph& state = states.front();
  mcmc::apply_maps(state, learned);
  prior = mcmc::prior_parameters(start, learned);
  const auto theta = mcmc::widen_spreads(
      mcmc::most_likely_parameters(mcmc::sufficient_statistics(state, mcmc::Density(prior)), prior,
                                   double(start.sketch.width) * start.sketch.height));
  return {std::move(state), theta, 1, 0};
}

/// User seconds by stage, of all sweeps.
struct Stages {
  double moves = 0, displacements = 0, learning = 0;
  [[nodiscard]] double sum() const { return moves + displacements + learning; }
};

void sweep(mcmc::Chain& chain, double proposals, Stages& stages) {
  double begun = user_seconds();
  const auto lap = [&](double& stage) {
    const double now = user_seconds();
    stage += now - begun, begun = now;
  };
  chain.move(proposals, {});
  lap(stages.moves);
  chain.redraw_displacements();
  lap(stages.displacements);
}

void learn(mcmc::Chain& chain, const mcmc::SamplerParameters& prior, Stages& stages) {
  const double begun = user_seconds();
  const auto& g = chain.state();
  const auto statistics = mcmc::sufficient_statistics(g, mcmc::Density(chain.theta()));
  chain.set_theta(
      mcmc::widen_spreads(mcmc::most_likely_parameters(statistics, prior, double(g.width()) * g.height())));
  stages.learning += user_seconds() - begun;
}

double evaluated(const mcmc::Chain& chain) {
  double sum = 0;
  for (const auto& count : chain.counts()) sum += count.evaluated;
  return sum;
}

void print_moves(const mcmc::Chain& chain) {
  const double all = evaluated(chain);
  std::printf("  %-14s %10s %10s %10s\n", "move", "eligible", "of all", "accepted");
  for (std::size_t m = 0; m < mcmc::moves().size(); ++m) {
    const auto& count = chain.counts()[m];
    std::printf("  %-14s %8.1f %% %8.1f %% %8.2f %%\n", std::string(mcmc::moves()[m].name).c_str(),
                100 * count.evaluated / std::max(1.0, count.tried), 100 * count.evaluated / all,
                100 * count.accepted / std::max(1.0, count.evaluated));
  }
}

using Indicators = std::map<std::tuple<int, graph::EventType, int, int>, std::vector<double>>;

/// Which events this state has, told by class, frame and a cell of 20 px.
void note_events(const mcmc::HiddenGraph& g, std::size_t draw, std::size_t draws, Indicators& indicators) {
  for (const auto& event : graph::stroke_events(mcmc::motion_graph(g, 25))) {
    auto& list = indicators[{event.frame, event.type, static_cast<int>(event.position.x / 20),
                             static_cast<int>(event.position.y / 20)}];
    list.resize(draws);
    list[draw] = 1;
  }
}

void print_mixing(const Indicators& indicators, double draws, double seconds) {
  std::vector<double> sizes;
  for (const auto& [key, list] : indicators) {
    const double size = mcmc::effective_size(std::span(&list, 1));
    if (std::isfinite(size)) sizes.push_back(std::min(size, draws));
  }
  std::ranges::sort(sizes);
  const auto at = [&](double share) {
    return sizes.empty() ? 0 : sizes[static_cast<std::size_t>(share * double(sizes.size() - 1))];
  };
  std::printf(
      "  event indicators: %zu, of which %zu change in %.0f sweeps; effective draws a second of "
      "these: %.2f (median), %.2f (lowest tenth)\n",
      indicators.size(), sizes.size(), draws, at(0.5) / seconds, at(0.1) / seconds);
}

void print_clip(const std::string& name, const graph::SketchSequence& clip, const Arguments& arguments) {
  mcmc::SamplerParameters prior;
  mcmc::Chain chain = begin(graph::match(clip, {}), prior);
  Stages stages;
  const int burn_in = arguments.sweeps / 4;
  for (int n = 0; n < burn_in; ++n) {
    sweep(chain, arguments.proposals, stages);
    learn(chain, prior, stages);
  }
  Stages later;
  Indicators indicators;
  const int draws = arguments.sweeps - burn_in;
  for (int n = 0; n < draws; ++n) {
    sweep(chain, arguments.proposals, later);
    note_events(chain.state(), static_cast<std::size_t>(n), static_cast<std::size_t>(draws), indicators);
  }
  const double moves = stages.moves + later.moves;
  std::printf("%s: %zu frames of %d x %d, %zu candidate patches; %d sweeps, state %016llx\n", name.c_str(),
              clip.frames.size(), clip.width, clip.height, chain.state().size(), arguments.sweeps,
              static_cast<unsigned long long>(chain.state().hash()));
  std::printf(
      "  evaluated proposals a second and core: %.0f thousand (of moves alone), %.0f thousand (of "
      "whole sweeps)\n",
      evaluated(chain) / moves / 1e3,
      evaluated(chain) / (moves + stages.displacements + later.displacements) / 1e3);
  std::printf("  a sweep: %.1f ms of moves, %.1f ms of sways; learning after it: %.1f ms\n",
              1e3 * moves / arguments.sweeps,
              1e3 * (stages.displacements + later.displacements) / arguments.sweeps,
              1e3 * stages.learning / burn_in);
  print_mixing(indicators, draws, later.sum());
  print_moves(chain);
  std::fflush(stdout);
}

void print_growth(const std::string& name, const graph::SketchSequence& clip, double proposals) {
  constexpr int kSweeps = 4;
  std::printf("%s to and fro: a sweep and its learning\n", name.c_str());
  for (const int frames : {100, 200, 400, 800, 2000}) {
    const auto longer = to_and_fro(clip, frames);
    mcmc::SamplerParameters prior;
    double begun = user_seconds();
    const auto start = graph::match(longer, {});
    const double matched = user_seconds() - begun;
    begun = user_seconds();
    mcmc::Chain chain = begin(start, prior);
    const double beginning = user_seconds() - begun;
    Stages stages;
    for (int n = 0; n < kSweeps; ++n) {
      sweep(chain, proposals, stages);
      learn(chain, prior, stages);
    }
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    std::printf(
        "  %5d frames: %8.1f ms, %.3f ms a frame (match %.2f s, beginning %.2f s, most memory %ld MB)\n",
        frames, 1e3 * stages.sum() / kSweeps, 1e3 * stages.sum() / kSweeps / frames, matched, beginning,
        usage.ru_maxrss / 1024);
    std::fflush(stdout);
  }
}

}  // namespace

int main(int count, char** words) {
  try {
    const Arguments arguments = parse({words + 1, words + count});
    for (const auto& name : arguments.clips) {
      const auto clip = sketched(name, arguments.frames);
      if (clip.frames.size() < 10) throw std::runtime_error(name + " has fewer than ten frames");
      print_clip(name, clip, arguments);
      print_growth(name, clip, arguments.proposals);
    }
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "sampler_figures: " << error.what() << '\n';
  }
  return 1;
}
