// SPDX-License-Identifier: Apache-2.0
#include "apps/page/texture_page.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "apps/page/packed_text.hpp"
#include "apps/page/page_assets.hpp"
#include "apps/page/page_title.hpp"
#include "apps/report/report.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "dytex/editing/edit.hpp"
#include "dytex/editing/edit_dynamics.hpp"

namespace emberfold::apps {

namespace {

using dytex::LinearDynamicTexture;
using Eigen::Index;
using Json = nlohmann::ordered_json;

constexpr double kError = 0.2;  // levels, RMS, total effect of rounding all components
constexpr double kMeanStep = 0.125;
constexpr int kMostSteps = 32'000, kNarrowSteps = 127;  // on either side of 0: two bytes, one

// Collects all doubles of a page in one array, with the offset of each matrix; column-major.
struct Numbers {
  std::vector<double> values;
  Json places = Json::object();

  void put(const std::string& name, const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
    places[name] = {values.size(), matrix.rows(), matrix.cols()};
    for (Index j = 0; j < matrix.cols(); ++j)
      for (Index i = 0; i < matrix.rows(); ++i) values.push_back(matrix(i, j));
  }
};

std::string count_text(long long value, const std::string& what, long long most) {
  return std::to_string(value) + " " + what + ", a page takes at most " + std::to_string(most);
}

void check_size(const LinearDynamicTexture& texture) {
  const std::string way_out = ": learn it with fewer --components or a smaller --scale";
  if (const long long values = texture.pixels() * texture.components(); values > kPageValues)
    throw core::InputError("the model's components have " + count_text(values, "values", kPageValues) +
                           way_out);
  if (const long long values = texture.pixels(); values > kPageValues)
    throw core::InputError("the model's frames have " + count_text(values, "values", kPageValues));
  if (texture.order() > kPageOrder)
    throw core::InputError("the model's state has " + count_text(texture.order(), "numbers", kPageOrder) +
                           way_out);
  if (const long long numbers = texture.states.size(); numbers > kPageNumbers)
    throw core::InputError("the model's states have " + count_text(numbers, "numbers", kPageNumbers) +
                           ": learn it from fewer frames, see --range");
}

// Lists the presets that only set the page's sliders.
Json preset_list() {
  Json list = Json::array();
  for (const dytex::PresetInfo& info : dytex::presets()) {
    double intensity = 1, speed = 1;
    dytex::Scales scales;
    bool fits = true;
    for (const dytex::Edit& edit : dytex::preset(info.name)) {
      if (const auto* one = std::get_if<dytex::Intensity>(&edit.what)) {
        intensity *= one->factor;
      } else if (const auto* three = std::get_if<dytex::Scales>(&edit.what)) {
        scales.coarse *= three->coarse, scales.medium *= three->medium, scales.fine *= three->fine;
      } else if (const auto* turned = std::get_if<dytex::Speed>(&edit.what)) {
        speed *= turned->factor;
      } else {
        fits = false;
      }
    }
    if (fits)
      list.push_back({{"name", info.name},
                      {"about", info.about},
                      {"speed", speed},
                      {"intensity", intensity},
                      {"coarse", scales.coarse},
                      {"medium", scales.medium},
                      {"fine", scales.fine}});
  }
  return list;
}

// Adds A and B, and the eigenvalues and vectors, from which other speeds are computed.
Json put_motion(Numbers& numbers, const std::string& name, const LinearDynamicTexture& texture) {
  numbers.put(name + ".A", texture.A);
  numbers.put(name + ".B", texture.B);
  Json blocks = Json::array();
  if (texture.components() == 0) return {{"blocks", std::move(blocks)}};
  const auto form = dytex::detail::speed_form(texture.A, dytex::stationary_covariance(texture.A, texture.B));
  numbers.put(name + ".basis", form.basis);
  numbers.put(name + ".inverse", form.inverse);
  numbers.put(name + ".diagonal", form.diagonal);
  numbers.put(name + ".turn", form.quarter_turn);
  for (const auto& block : form.blocks)
    blocks.push_back({{"first", block.first},
                      {"size", block.size},
                      {"phase", block.phase},
                      {"turns", dytex::detail::turns(block)},
                      {"alone", dytex::detail::is_alone(block)}});
  return {{"blocks", std::move(blocks)}};
}

// Adds the model forwards and exactly backwards, and the training frames.
Json put_dynamics(Numbers& numbers, const LinearDynamicTexture& texture) {
  Json data;
  data["forward"] = put_motion(numbers, "forward", texture);
  const std::array edits{dytex::Edit{dytex::Reverse{}}};
  const dytex::EditResult back = dytex::edit(texture, edits);
  data["backward"] = put_motion(numbers, "backward", back.texture);
  numbers.put("weights", texture.weights);
  numbers.put("states", texture.states.topRows(texture.components()));
  return data;
}

// Chooses the rounding steps such that all components contribute equally at their usual amplitude (of the
// training frames, or as drawn), and kError in total.
std::vector<float> component_steps(const LinearDynamicTexture& texture) {
  const Index n = texture.components();
  std::vector<float> steps;
  if (n == 0) return steps;
  const Eigen::MatrixXd P = dytex::stationary_covariance(texture.A, texture.B);
  for (Index i = 0; i < n; ++i) {
    const double learned =
        std::sqrt(texture.states.row(i).squaredNorm() / static_cast<double>(texture.states.cols()));
    const double amplitude =
        std::max(learned, std::abs(texture.weights[i]) * std::sqrt(std::max(P(i, i), 0.0)));
    const double largest = texture.C.col(i).cwiseAbs().maxCoeff();
    const double wanted =
        amplitude > 0 ? kError * std::sqrt(12 / static_cast<double>(n)) / amplitude : largest / kNarrowSteps;
    const double step = std::max(wanted, largest / kMostSteps);
    steps.push_back(step > 0 ? static_cast<float>(step) : 1.0F);
  }
  return steps;
}

float quantise(float value, float step) {
  return std::nearbyint(value / step);
}

struct Image {
  std::string text;
  bool wide = false;  ///< needs two bytes per value
};

Image pack_image(std::span<const float> values, float step, cv::Size size) {
  std::vector<std::int16_t> whole(values.size());
  std::ranges::transform(values, whole.begin(),
                         [step](float v) { return static_cast<std::int16_t>(quantise(v, step)); });
  const bool wide = std::ranges::any_of(whole, [](int v) { return std::abs(v) > kNarrowSteps; });
  return {packed_image(whole, size), wide};
}

// Packs the mean, then the components.
std::vector<Image> packed_images(const LinearDynamicTexture& texture, const std::vector<float>& steps) {
  const cv::Size size(texture.info.width, texture.info.height);
  const auto values = static_cast<std::size_t>(texture.pixels());
  std::vector<Image> images(steps.size() + 1);
  core::parallel_for(images.size(), {}, [&](std::size_t i) {
    images[i] = i == 0 ? pack_image({texture.mean.data(), values}, kMeanStep, size)
                       : pack_image({texture.C.data() + (i - 1) * values, values}, steps[i - 1], size);
  });
  return images;
}

// Measures the RMS and largest error of some training frames drawn from rounded images.
void measure_rounding(const LinearDynamicTexture& texture, const std::vector<float>& steps,
                      TexturePage& page) {
  constexpr Index kFrames = 8, kRows = 4096;
  const Index n = texture.components(), frames = std::min(kFrames, texture.states.cols());
  Eigen::MatrixXf states(n, frames);
  for (Index k = 0; k < frames; ++k)
    states.col(k) = texture.states.col(k * texture.states.cols() / frames).head(n).cast<float>();
  const auto blocks = static_cast<std::size_t>((texture.pixels() + kRows - 1) / kRows);
  std::vector<double> squares(blocks), largest(blocks);
  core::parallel_for(blocks, {}, [&](std::size_t b) {
    const Index first = static_cast<Index>(b) * kRows, rows = std::min(kRows, texture.pixels() - first);
    Eigen::MatrixXf wrong(rows, n);
    for (Index i = 0; i < n; ++i) {
      const float step = steps[static_cast<std::size_t>(i)];
      wrong.col(i) = texture.C.col(i).segment(first, rows).unaryExpr([step](float v) {
        return quantise(v, step) * step - v;
      });
    }
    Eigen::MatrixXf error = wrong * states;
    error.colwise() += texture.mean.segment(first, rows).unaryExpr([](float v) {
      return quantise(v, kMeanStep) * static_cast<float>(kMeanStep) - v;
    });
    squares[b] = error.cast<double>().squaredNorm();
    largest[b] = static_cast<double>(error.cwiseAbs().maxCoeff());
  });
  double sum = 0;
  for (const double part : squares) sum += part;
  page.error = std::sqrt(sum / static_cast<double>(texture.pixels() * frames));
  page.largest_error = *std::ranges::max_element(largest);
}

}  // namespace

TexturePage make_texture_page(const TexturePageInput& input) {
  const LinearDynamicTexture& texture = *input.texture;
  dytex::validate(texture);
  check_size(texture);
  const std::vector<float> steps = component_steps(texture);
  const std::vector<Image> images = packed_images(texture, steps);
  TexturePage page;
  measure_rounding(texture, steps, page);

  const core::ClipInfo& info = texture.info;
  const auto title = page_title(input.model);
  Json data = {{"title", title},
               {"model", shown_path(input.model)},
               {"edits", input.edits},
               {"version", input.version},
               {"width", info.width},
               {"height", info.height},
               {"channels", info.channels},
               {"fps", info.fps},
               {"frames", texture.states.cols()},
               {"components", texture.components()},
               {"order", texture.order()},
               {"mean_step", kMeanStep},
               {"steps", steps},
               {"presets", preset_list()}};
  data["wide"] = Json::array();
  std::string image_elements;
  for (const Image& image : images) {
    data["wide"].push_back(image.wide);
    image_elements += "<script type=\"text/plain\" class=\"image\">" + image.text + "</script>\n";
  }
  Numbers numbers;
  data.update(put_dynamics(numbers, texture));
  data["numbers"] = numbers.places;
  page.html = fill_in(kPageTemplate, {{"title", escape_html(title)},
                                      {"style", kPageStyle},
                                      {"data", embed_json(data)},
                                      {"numbers", packed_numbers(numbers.values)},
                                      {"images", image_elements},
                                      {"script", kPageScript}});
  return page;
}

}  // namespace emberfold::apps
