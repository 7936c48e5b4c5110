// SPDX-License-Identifier: Apache-2.0
// Measures events and learned motion and prints two tables; docs/benchmarks.md tells how to run it.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/parallel.hpp"
#include "graph/events/event_score.hpp"
#include "tests/bench/events/clips.hpp"
#include "tests/bench/events/lap.hpp"
#include "tests/bench/events/matched.hpp"
#include "tests/bench/figures/inputs.hpp"

using namespace emberfold;
using namespace emberfold::figures;

namespace {

constexpr std::array<const char*, 3> kClips{"flag.avi", "river.mp4", "smoke.mp4"};
constexpr int kFlicker = 3, kLasting = 4;  // frames: the match's own; what lasts 5 frames is left by 4
constexpr double kNoise = 2;

struct Arguments {
  std::filesystem::path scenes, clips;
  int frames = 100;   // of a clip
  bool peers = true;  // assignment
  std::string only;   // a scene or clip
};

std::string from_environment(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

Arguments parse(const std::vector<std::string>& words) {
  Arguments a{from_environment("EMBERFOLD_SCENES"), from_environment("EMBERFOLD_CLIPS"), 100, true, {}};
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& option = words[i];
    if (option == "--no-peers") {
      a.peers = false;
      continue;
    }
    if (option != "--clips" && option != "--scenes" && option != "--frames" && option != "--only")
      throw std::runtime_error("no option " + option +
                               "; usage: event_figures [--scenes DIR] [--clips DIR] [--frames N] [--only "
                               "NAME] [--no-peers]");
    if (++i == words.size()) throw std::runtime_error(option + " needs a value");
    if (option == "--clips") a.clips = words[i];
    if (option == "--scenes") a.scenes = words[i];
    if (option == "--only") a.only = words[i];
    if (option == "--frames") a.frames = std::atoi(words[i].c_str());
  }
  if (a.frames < 10) throw std::runtime_error("--frames must be a number from 10");
  return a;
}

std::string number(double value, int digits) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  return std::isnan(value) ? "-" : text.data();
}

struct F1 {
  double four = NAN, six = NAN;
};
F1 f1(const std::vector<graph::Event>& truth, const std::vector<graph::Event>& found) {
  const auto score = graph::score_events(truth, found);
  return {score.four.back().f1(), score.six.back().f1()};
}
std::string shown(F1 f) {
  return number(f.four, 3) + " " + number(f.six, 3);
}

/// The best of many settings, each scored against the truth: a favour that no user can do a peer.
F1 best_of(const std::vector<std::function<std::vector<graph::Event>()>>& settings,
           const std::vector<graph::Event>& truth) {
  std::vector<F1> scores(settings.size());
  core::parallel_for(settings.size(), {}, [&](std::size_t i) { scores[i] = f1(truth, settings[i]()); });
  F1 best{-1, -1};
  for (const F1 f : scores)
    if (f.four > best.four) best = f;
  return best;
}

using Settings = std::vector<std::function<std::vector<graph::Event>()>>;

Settings stroke_settings(const graph::SketchSequence& sketch) {
  Settings list;
  const auto add = [&](const LapOptions& options) {
    list.emplace_back([&sketch, options] { return lap_strokes(sketch, options); });
  };
  for (const std::size_t least : {1, 2, 4, 8}) {
    for (const double link : {8.0, 15.0, 30.0, 60.0})
      for (const double branch : {0.0, 30.0, 60.0, 120.0})
        add({LapCost::middles, link * link, branch * branch, 2, least});
    for (const double link : {0.7, 0.9, 0.98})
      for (const double branch : {0.0, 0.3, 0.6, 0.9}) add({LapCost::overlap, link, branch, 2, least});
  }
  return list;
}

Settings patch_settings(const graph::SketchSequence& sketch) {
  Settings list;
  for (const double distance : {4.0, 6.0, 8.0, 12.0})
    list.emplace_back([&sketch, distance] { return lap_patches(sketch, distance); });
  return list;
}

// ---- the second table: what a clip tells of itself

std::string deviation(double learned, double truth) {
  return number(learned, 3) +
         (std::isnan(truth) ? "" : " (" + number(100 * (learned / truth - 1), 1) + " %)");
}

using Method = std::function<Found(const EventClip&)>;

void print_own(const std::string& method, const EventClip& clip, const Method& run, double a1, double a2) {
  const Found found = run(clip);
  const auto& events = found.events;
  const auto turned = run(backwards(clip)).events;
  const auto back = told_forwards(turned, static_cast<int>(clip.frames.size()));
  const auto noisy = run(with_noise(clip, kNoise, 5)).events;
  std::printf("%-10s | %-8s | %17s | %18s | %5s %4zu/%-4zu | %5s %4zu/%-4zu| %7s\n", clip.name.c_str(),
              method.c_str(), deviation(found.a1, a1).c_str(), deviation(found.a2, a2).c_str(),
              number(agreement(events, back), 3).c_str(), events.size(), back.size(),
              number(agreement(events, noisy), 3).c_str(), events.size(), noisy.size(),
              number(found.seconds, 2).c_str());
  std::fflush(stdout);
}

void print_all_own(const EventClip& clip, double a1, double a2) {
  print_own(
      "raw", clip, [](const EventClip& c) { return matched_events(c, 0); }, a1, a2);
  print_own(
      "match", clip, [](const EventClip& c) { return matched_events(c, kFlicker); }, a1, a2);
  print_own(
      "lasting", clip, [](const EventClip& c) { return matched_events(c, kLasting); }, a1, a2);
}

void print_scores(const EventScene& scene, bool peers) {
  const Found raw = matched_events(scene.clip, 0), steadied = matched_events(scene.clip, kFlicker);
  std::vector<F1> row{f1(scene.truth, raw.events), f1(scene.truth, steadied.events)};
  for (const auto& settings : {stroke_settings, patch_settings})
    for (const auto* sketch : {&scene.clip.sketch, &steadied.sketch})
      row.push_back(peers ? best_of(settings(*sketch), scene.truth) : F1{});
  std::printf("%-10s", scene.clip.name.c_str());
  for (const F1 f : row) std::printf(" | %11s", shown(f).c_str());
  std::printf("\n");
  std::fflush(stdout);
}

void print_score_heading() {
  std::printf("F1, four and six classes, 2 frames, 20 px\n%-10s", "scene");
  for (const char* column : {"raw match", "match", "LAP strokes", "- steadied", "LAP patches", "- steadied"})
    std::printf(" | %-11s", column);
  std::printf("\n");
}

std::vector<EventScene> read_scenes_of(const Arguments& arguments) {
  std::vector<EventScene> scenes;
  try {
    for (const auto& folder : scene_folders(arguments.scenes))
      if (arguments.only.empty() || folder.filename() == arguments.only)
        scenes.push_back(read_event_scene(folder, 1 << 20));
  } catch (const Missing& missing) {
    std::printf("scenes: skipped, there is no %s\n", missing.what.c_str());
  }
  return scenes;
}

void run(const Arguments& arguments) {
  const auto scenes = read_scenes_of(arguments);
  print_score_heading();
  for (const EventScene& scene : scenes) print_scores(scene, arguments.peers);
  std::printf("\n%-10s | %-8s | %-17s | %-18s | %-14s | %-14s | %s\n", "", "", "a1 (off by)", "a2 (off by)",
              "backwards", "noise", "CPU s");
  for (const EventScene& scene : scenes) print_all_own(scene.clip, scene.a1, scene.a2);
  for (const char* file : kClips) {
    const auto name = std::filesystem::path(file).stem().string();
    if (!arguments.only.empty() && name != arguments.only) continue;
    try {
      if (arguments.clips.empty()) throw Missing{"a folder of clips (--clips, EMBERFOLD_CLIPS)"};
      print_all_own(read_event_clip(arguments.clips / file, name, 40, arguments.frames), NAN, NAN);
    } catch (const Missing& missing) {
      std::printf("%s: skipped, there is no %s\n", name.c_str(), missing.what.c_str());
    }
  }
}

}  // namespace

int main(int count, char** words) {
  try {
    run(parse({words + 1, words + count}));
    return 0;
  } catch (const Missing& missing) {
    std::cerr << "event_figures: there is no " << missing.what << '\n';
  } catch (const std::exception& error) {
    std::cerr << "event_figures: " << error.what() << '\n';
  }
  return 1;
}
