// SPDX-License-Identifier: Apache-2.0
// Clips of classes that differ in their dynamics alone.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "core/clip.hpp"
#include "core/io/clip_writer.hpp"
#include "core/rng.hpp"
#include "tests/apps/commands/command_check.hpp"

namespace emberfold::test {

/// Waves that run over the frame: their speed, and how long a whim of theirs lasts, are the class.
struct Waves {
  double angle = 0.5;    // rad a frame
  double radius = 0.95;  // what is left of a deflection after a frame
};

/// A grey clip of four random sine patterns whose phases a second-order auto-regression moves.
inline std::string write_waves(const std::filesystem::path& path, const Waves& waves, std::uint64_t seed,
                               cv::Size size = {24, 20}, int frames = 60) {
  constexpr int kPatterns = 4;
  core::Rng rng(seed);
  std::vector<cv::Mat1f> shapes;
  for (int k = 0; k < 2 * kPatterns; ++k) {
    cv::Mat1f shape(size);
    const double fx = 0.4 + 0.2 * std::floor(k / 2.0), fy = 0.3 + 0.15 * (k / 2 % 3),
                 quarter = k % 2 * std::numbers::pi / 2;
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x)
        shape(y, x) = static_cast<float>(20 * std::sin(fx * x + fy * y + quarter));
    shapes.push_back(shape);
  }
  std::vector<std::array<double, 2>> state(kPatterns);
  const double c = waves.radius * std::cos(waves.angle), s = waves.radius * std::sin(waves.angle);
  const double drive = std::sqrt(1 - waves.radius * waves.radius);
  std::filesystem::create_directories(path.parent_path());
  const auto writer = io::create_video(path, size, 25, false);
  for (int t = -100; t < frames; ++t) {
    cv::Mat1f levels(size, 128.0F);
    for (int k = 0; k < kPatterns; ++k) {
      auto& [u, v] = state[static_cast<std::size_t>(k)];
      const double next = c * u - s * v + drive * rng.normal();
      v = s * u + c * v + drive * rng.normal();
      u = next;
      levels += static_cast<float>(u) * shapes[2 * static_cast<std::size_t>(k)] +
                static_cast<float>(v) * shapes[2 * static_cast<std::size_t>(k) + 1];
    }
    for (float& value : levels) value += static_cast<float>(2 * rng.normal());
    if (t >= 0) writer->write(core::to_bytes(levels));
  }
  writer->finish();
  return path.string();
}

/// classes/slow, /medium, /quick with so many clips each.
inline std::string write_classes(const std::filesystem::path& folder, int clips, cv::Size size = {24, 20}) {
  const std::vector<std::pair<std::string, Waves>> kinds{
      {"slow", {0.15, 0.97}}, {"medium", {0.9, 0.9}}, {"quick", {2, 0.95}}};
  std::uint64_t seed = 1;
  for (const auto& [name, waves] : kinds)
    for (int i = 0; i < clips; ++i)
      write_waves(folder / name / ("clip" + std::to_string(i)), waves, seed++, size);
  return folder.string();
}

inline std::string learn_texture(const std::string& clip, const std::filesystem::path& model,
                                 const std::string& components = "8") {
  REQUIRE(run_command({"dytex", "learn", clip, "-o", model.string(), "-n", components, "-q"}).exit == 0);
  return model.string();
}

}  // namespace emberfold::test
