// SPDX-License-Identifier: Apache-2.0
// What the page calls (apps/motion_page/simulation.js). One model, one clip at a time.
#include <cstdlib>
#include <cstring>
#include <exception>
#include <optional>
#include <sstream>
#include <string>
#include <typeinfo>
#include <vector>

#include "apps/motion_page/wasm/drawn_frame.hpp"
#include "core/model_archive.hpp"

using namespace emberfold;

#define EXPORT(name) __attribute__((export_name(#name))) name

namespace {

struct Simulation {
  core::ModelArchive archive;
  apps::PageLook look;
  mcmc::MotionModel model, edited;
  std::optional<apps::DrawnFrames> frames;
  std::vector<double> patches;
  std::vector<std::uint32_t> edges;
};

Simulation& simulation() {
  static Simulation all;
  return all;
}

template <class T>
std::vector<T> copy(const T* from, int count) {
  return {from, from + count};
}

// Writes the graph: id, x, y and direction of every patch; pairs of patch indices.
void lay_out(Simulation& all) {
  const auto& graph = all.frames->graph();
  all.patches.clear(), all.edges.clear();
  for (const auto& vertex : graph.vertices()) {
    const auto& patch = vertex.patch;
    for (const double value : {double(vertex.id.value), patch.position.x, patch.position.y, patch.theta})
      all.patches.push_back(value);
  }
  for (const auto& edge : graph.edges())
    for (const auto id : {edge.a, edge.b})
      all.edges.push_back(static_cast<std::uint32_t>(graph.index_of(id)));
}

}  // namespace

extern "C" {

// Stops the call and passes an error message to the page; never returns.
[[noreturn]] __attribute__((import_module("page"), import_name("fail"))) void page_fail(const char* words);

// Exceptions do not unwind here: a call that throws is the last one of this instance.
void* __cxa_allocate_exception(std::size_t size) {
  return std::malloc(size);
}
void __cxa_throw(void* thrown, std::type_info*, void (*)(void*)) {
  page_fail(static_cast<std::exception*>(thrown)->what());
}

void* EXPORT(room)(int bytes) {
  return std::malloc(static_cast<std::size_t>(bytes));
}
void EXPORT(release)(void* room) {
  std::free(room);
}

// Stores a file of the model's folder: model.json, or an array, named without ".npy".
void EXPORT(add_file)(const char* name, const char* bytes, int size) {
  auto& all = simulation();
  const std::string content(bytes, static_cast<std::size_t>(size));
  if (std::strcmp(name, "model.json") == 0) {
    all.archive.text = content;
  } else {
    std::istringstream in(content);
    all.archive.arrays[name] = core::read_npy(in, std::size_t{1} << 30);
  }
}

void EXPORT(set_look)(int channels, double blur_share, double contrast_gain) {
  auto& look = simulation().look;
  look.channels = channels, look.blur_share = blur_share, look.contrast_gain = contrast_gain;
}

void EXPORT(set_range)(int columns, int rows, int channels, const std::uint8_t* low,
                       const std::uint8_t* high) {
  auto& look = simulation().look;
  look.range_columns = columns, look.range_rows = rows, look.range_channels = channels;
  look.range_low = copy(low, columns * rows * channels),
  look.range_high = copy(high, columns * rows * channels);
}

void EXPORT(set_still)(int pixels, const std::uint8_t* levels, const std::uint8_t* still,
                       const std::uint8_t* fixed) {
  auto& look = simulation().look;
  look.still_levels.assign(levels, levels + pixels * look.channels);
  look.still = copy(still, pixels), look.fixed = copy(fixed, pixels);
}

void EXPORT(read_model)() {
  auto& all = simulation();
  all.model = all.edited = mcmc::motion_model(all.archive);
  all.archive = {};
}

// Edits the model. `factors`: speed, reverse, intensity, flicker, contrast, wind in x and y, and six rates.
void EXPORT(edit)(const double* factors, std::uint32_t seed_low, std::uint32_t seed_high) {
  auto& all = simulation();
  mcmc::MotionEdit edit;
  edit.speed = factors[0], edit.reverse = factors[1] != 0, edit.intensity = factors[2];
  edit.flicker = factors[3], edit.contrast = factors[4], edit.wind = {factors[5], factors[6]};
  std::copy_n(factors + 7, edit.rates.size(), edit.rates.begin());
  const std::uint64_t seed = std::uint64_t{seed_high} << 32 | seed_low;
  all.edited = mcmc::edit_motion(all.model, edit, seed).model;
}

void EXPORT(begin)(std::uint32_t seed_low, std::uint32_t seed_high) {
  auto& all = simulation();
  all.frames.emplace(all.edited, all.look, std::uint64_t{seed_high} << 32 | seed_low);
}

void EXPORT(next)() {
  auto& all = simulation();
  all.frames->next();
  lay_out(all);
}

const std::uint8_t* EXPORT(pixels)() {
  return simulation().frames->pixels().data();
}
const int* EXPORT(operators)() {
  return simulation().frames->operators().data();
}
int EXPORT(patch_count)() {
  return static_cast<int>(simulation().patches.size() / 4);
}
const double* EXPORT(patches)() {
  return simulation().patches.data();
}
int EXPORT(edge_count)() {
  return static_cast<int>(simulation().edges.size() / 2);
}
const std::uint32_t* EXPORT(edges)() {
  return simulation().edges.data();
}

}  // extern "C"
