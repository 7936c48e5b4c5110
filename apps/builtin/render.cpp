// SPDX-License-Identifier: Apache-2.0
#include "apps/builtin/render.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/builtin/line_drawing.hpp"
#include "apps/builtin/style.hpp"
#include "core/math/bilinear.hpp"

namespace emberfold::apps {

namespace {

using std::numbers::pi;

// Returns the relative contrast along a line of length 1. A flame is brightest just above its foot.
double taper(BuiltinScene scene, double s) {
  if (scene == BuiltinScene::fire) return std::min(0.62 + 2.4 * s, 1.06 - 0.46 * s);
  return 0.6 + 0.4 * std::sqrt(std::sin(pi * std::clamp(s, 0.0, 1.0)));
}

// Returns the relative width along a line of length 1.
double slimness(BuiltinScene scene, double s) {
  return scene == BuiltinScene::fire ? std::min(0.95 + 2 * s, 1.4 - 0.7 * s) : 0.75 + 0.25 * std::sin(pi * s);
}

std::vector<Dab> dabs_of(const Scene& scene, const Body& body, std::size_t curve, int frame) {
  const Line line = line_at(scene.options, body, body.curves[curve], frame);
  const double there = body.life.contrast_at(frame) * body.contrast;
  std::vector<Dab> dabs(line.size());
  for (std::size_t i = 0; i < line.size(); ++i) {
    const double s = static_cast<double>(i) / static_cast<double>(line.size() - 1);
    const double left = curve == 0 ? gap_contrast(body, static_cast<double>(i), frame) : 1;
    dabs[i] = {line[i], there * left * contrast_profile(scene, body, i, line.size(), frame),
               body.sigma * slimness(scene.options.scene, s)};
  }
  return dabs;
}

// Returns a sum of long drifting waves, mostly −1 … 1, on a grid of every fourth pixel, which resolves their
// length.
cv::Mat draw_waves(const BuiltinOptions& o, int frame) {
  constexpr int waves = 5;
  const bool fire = o.scene == BuiltinScene::fire, cloth = o.scene == BuiltinScene::cloth;
  cv::Mat field = cv::Mat::zeros(o.height / 4 + 2, o.width / 4 + 2, CV_32F);
  core::Rng rng(o.seed, {static_cast<std::uint32_t>(Purpose::ground), 0, 0});
  for (int i = 0; i < waves; ++i) {
    const double k = 2 * pi / (cloth ? rng.uniform(110, 260) : rng.uniform(80, 200));
    // Bands are horizontal in water and vertical in cloth; waves drift upwards in fire, elsewhere in any
    // direction.
    const double heading = fire    ? rng.uniform(0, 2 * pi)
                           : cloth ? rng.uniform(-0.6, 0.6)
                                   : pi / 2 + rng.uniform(-0.5, 0.5);
    const double kx = k * std::cos(heading), ky = k * std::sin(heading), phase = rng.uniform(0, 2 * pi);
    const double turn = fire ? 1.6 * ky : k * rng.uniform(-0.35, 0.35);
    for (int y = 0; y < field.rows; ++y)
      for (int x = 0; x < field.cols; ++x)
        field.at<float>(y, x) +=
            static_cast<float>(1.6 / waves * std::cos(4 * (kx * x + ky * y) + turn * frame + phase));
  }
  return field;
}

// Returns the background's grey level (heat, for fire) from the waves there.
double ground_level(const BuiltinOptions& o, double waves, int x, int y) {
  const double across = (x - o.width / 2.0) / o.width, up = 1 - static_cast<double>(y) / o.height;
  switch (o.scene) {
    case BuiltinScene::fire: {
      const double width = 0.34 - 0.2 * up;
      const double body = std::exp(-across * across / (2 * width * width) - 2.2 * up);
      const double bed = std::exp(-up / 0.08 - across * across / 0.16);
      return 3 + 72 * body * (1 + 0.3 * waves) + 46 * bed * (1 + 0.2 * waves);
    }
    case BuiltinScene::cloth:
      return 112 + 22 * waves - 30 * across + 14 * up;
    case BuiltinScene::river:
      return 74 + 11 * waves + 34 * up * up;
  }
  return 0;
}

// Returns the soft light around strokes: a flame's glow, a fold's lit and shaded flank, a crest's shimmer.
cv::Mat halo_of(BuiltinScene scene, const cv::Mat& strokes) {
  cv::Mat soft, halo;
  if (scene == BuiltinScene::fire) {
    cv::GaussianBlur(strokes, soft, {}, 8, 15, cv::BORDER_REPLICATE);
    return 1.5 * soft;
  }
  if (scene == BuiltinScene::river) {
    cv::GaussianBlur(strokes, soft, {}, 14, 6, cv::BORDER_REPLICATE);
    return 0.6 * soft;
  }
  cv::GaussianBlur(strokes, soft, {}, 9, 16, cv::BORDER_REPLICATE);
  cv::Mat light = cv::Mat::zeros(1, 13, CV_32F);  // from the left
  light.at<float>(0) = -1.2F;
  light.at<float>(6) = 0.9F;
  light.at<float>(12) = 1.6F;
  cv::filter2D(soft, halo, CV_32F, light, {-1, -1}, 0, cv::BORDER_REPLICATE);
  return halo;
}

cv::Vec3d colour_of(BuiltinScene scene, double level) {
  // Tints whose luma is the level itself; for fire, black, deep red, orange, yellow, nearly white.
  if (scene == BuiltinScene::cloth) return cv::Vec3d(0.85, 0.898, 1.258) * level;
  if (scene == BuiltinScene::river) {  // blue depths, paler crests
    const double pale = std::clamp((level - 80) / 90, 0.0, 1.0);
    return ((1 - pale) * cv::Vec3d(1.42, 1.06, 0.722) + pale * cv::Vec3d(1.18, 1.02, 0.892)) * level;
  }
  const double h = std::max(level, 0.0) / 255;
  return {9 + 177 * h * h * h, 8 + 243 * h * std::cbrt(h), 9 + 244 * (1 - std::exp(-3.4 * h))};
}

}  // namespace

double contrast_profile(const Scene& scene, const Body& body, std::size_t i, std::size_t n, int frame) {
  const Style& style = style_of(scene.options.scene);
  const double s = static_cast<double>(i) / static_cast<double>(n - 1);
  const double wave =
      2 * pi * (2 * static_cast<double>(i) / style.flicker_wave - frame / style.flicker_period) + body.phase;
  return taper(scene.options.scene, s) * (1 + style.flicker * std::sin(wave));
}

cv::Mat render_strokes(const Scene& scene, int frame) {
  std::array<cv::Mat, 2> fields;  // ridges, valleys
  for (cv::Mat& field : fields) field = cv::Mat::zeros(scene.options.height, scene.options.width, CV_32F);
  for (const Body& body : scene.bodies)
    if (body.life.contrast_at(frame) > 0)
      for (std::size_t c = 0; c < body.curves.size(); ++c)
        draw_line(fields[body.polarity > 0 ? 0 : 1], dabs_of(scene, body, c, frame));
  for (const Bridge& bridge : scene.bridges)
    if (const double there = bridge.presence.contrast_at(frame); there > 0) {
      std::vector<Dab> dabs;
      for (const auto& p : line_at(scene, bridge, frame))
        dabs.push_back({p, there * bridge.contrast, bridge.sigma});
      draw_line(fields[scene.bodies[bridge.from.body].polarity > 0 ? 0 : 1], dabs);
    }
  return fields[0] - fields[1];
}

cv::Mat render_frame(const Scene& scene, int frame) {
  const BuiltinOptions& o = scene.options;
  const cv::Mat strokes = render_strokes(scene, frame);
  const cv::Mat halo = halo_of(o.scene, strokes), waves = draw_waves(o, frame);
  core::Rng noise(o.seed, {static_cast<std::uint32_t>(Purpose::noise), static_cast<std::uint32_t>(frame), 0});
  cv::Mat image(o.height, o.width, CV_8UC3);
  for (int y = 0; y < o.height; ++y)
    for (int x = 0; x < o.width; ++x) {
      const double level = ground_level(o, core::sample_bilinear(waves, x / 4.0, y / 4.0), x, y) +
                           static_cast<double>(halo.at<float>(y, x)) +
                           static_cast<double>(strokes.at<float>(y, x));
      const cv::Vec3d colour = colour_of(o.scene, level) + cv::Vec3d::all(builtin_noise * noise.normal());
      for (int c = 0; c < 3; ++c) image.at<cv::Vec3b>(y, x)[c] = cv::saturate_cast<std::uint8_t>(colour[c]);
    }
  return image;
}

}  // namespace emberfold::apps
