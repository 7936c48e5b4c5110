// SPDX-License-Identifier: Apache-2.0
#include "apps/textures/texture_modes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iomanip>
#include <limits>
#include <numbers>
#include <sstream>

#include <nlohmann/json.hpp>

#include "dytex/learning/decompositions.hpp"
#include "pipeline/parameter_count.hpp"

namespace emberfold::apps {

using Json = nlohmann::ordered_json;

namespace {

Json finite_json(double value, double per) {
  return std::isfinite(value) ? Json(std::round(value * per) / per) : Json(nullptr);
}

// Writes a number in a column of a table.
std::string column(double value, int width, int digits) {
  std::ostringstream out;
  if (std::isfinite(value))
    out << std::fixed << std::setprecision(digits) << std::setw(width) << value;
  else
    out << std::setw(width) << '-';
  return out.str();
}

// Returns "50 noises", "2 noises, with 98.10 % of what drove the clip" and similar.
std::string noise_text(const dytex::LinearDynamicTexture& texture) {
  std::string text = std::to_string(texture.B.cols());
  text += texture.B.cols() == 1 ? " noise" : " noises";
  if (texture.noise_share < 1)
    text += ", with " + column(100 * texture.noise_share, 0, 2) + " % of what drove the clip";
  return text;
}

}  // namespace

double TextureMode::period() const {
  return angle > 0 ? 2 * std::numbers::pi / angle : std::numeric_limits<double>::infinity();
}

double TextureMode::decay() const {
  if (radius <= 0) return 0;
  return radius < 1 ? -1 / std::log(radius) : std::numeric_limits<double>::infinity();
}

std::vector<std::complex<double>> texture_eigenvalues(const dytex::LinearDynamicTexture& texture) {
  if (texture.order() == 0) return {};
  const Eigen::VectorXcd poles = dytex::detail::eigenvalues(texture.A);
  std::vector<std::complex<double>> values(poles.begin(), poles.end());
  // Conjugate pairs stay together, positive imaginary part first: radius and |angle| are equal.
  std::ranges::stable_sort(values, [](const auto& a, const auto& b) {
    const auto key = [](const auto& z) { return std::pair{-std::norm(z), std::abs(z.imag())}; };
    return key(a) != key(b) ? key(a) < key(b) : a.imag() > b.imag();
  });
  return values;
}

std::vector<TextureMode> texture_modes(const dytex::LinearDynamicTexture& texture) {
  std::vector<TextureMode> modes;
  for (const auto& value : texture_eigenvalues(texture))
    if (value.imag() >= 0) modes.push_back({std::abs(value), std::arg(value), value.imag() > 0});
  return modes;
}

double share_of_variance(const dytex::LinearDynamicTexture& texture, Eigen::Index count) {
  const double all = texture.singular.squaredNorm();
  return all > 0 ? texture.singular.head(std::min(count, texture.singular.size())).squaredNorm() / all : 1;
}

Json texture_json(const dytex::LinearDynamicTexture& texture) {
  Json modes = Json::array();
  for (const auto& mode : texture_modes(texture))
    modes.push_back({{"radius", finite_json(mode.radius, 1e6)},
                     {"period", finite_json(mode.period(), 1e3)},
                     {"decay", finite_json(mode.decay(), 1e3)},
                     {"pair", mode.pair}});
  return {{"width", texture.info.width},
          {"height", texture.info.height},
          {"channels", texture.info.channels},
          {"fps", texture.info.fps},
          {"frames", texture.states.cols()},
          {"components", texture.components()},
          {"parameters", pipeline::parameter_count(texture)},
          {"order", texture.order()},
          {"noise_inputs", texture.B.cols()},
          {"noise_share", finite_json(texture.noise_share, 1e6)},
          {"share_of_variance", finite_json(share_of_variance(texture, texture.components()), 1e6)},
          {"spectral_radius", finite_json(dytex::spectral_radius(texture.A), 1e6)},
          {"r", finite_json(texture.r, 1e6)},
          {"modes", std::move(modes)}};
}

std::string texture_table(const dytex::LinearDynamicTexture& texture, std::size_t slowest) {
  const auto& info = texture.info;
  std::ostringstream out;
  out << "linear dynamic texture\n  frames              " << info.width << " x " << info.height << ", "
      << (info.channels == 3 ? "colour" : "grey") << ", " << info.fps << " a second\n  learned from        "
      << texture.states.cols() << " frames\n  components          " << texture.components()
      << "\n  parameters          " << static_cast<std::int64_t>(pipeline::parameter_count(texture))
      << "\n  order               " << texture.order() << ", driven by " << noise_text(texture)
      << "\n  share of variance   " << column(100 * share_of_variance(texture, texture.components()), 0, 2)
      << " %\n  spectral radius     " << column(dytex::spectral_radius(texture.A), 0, 5)
      << "\n  left out            r = " << std::setprecision(4) << texture.r << " levels^2 (SD "
      << std::sqrt(texture.r) << " levels" << (texture.noise.size() > 0 ? ", by place)\n" : ")\n");
  const auto modes = texture_modes(texture);
  if (modes.empty()) return out.str();
  out << "\nslowest modes     radius    period     decay   (frames)\n";
  for (std::size_t i = 0; i < std::min(slowest, modes.size()); ++i)
    out << std::setw(5) << i + 1 << (modes[i].pair ? " pair   " : " real   ")
        << column(modes[i].radius, 11, 5) << column(modes[i].period(), 10, 1)
        << column(modes[i].decay(), 10, 1) << '\n';
  if (modes.size() > slowest) out << "  and " << modes.size() - slowest << " more\n";
  return out.str();
}

}  // namespace emberfold::apps
