// SPDX-License-Identifier: Apache-2.0
#include "mcmc/simulation/edit_model.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <utility>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "graph/events/events.hpp"
#include "mcmc/learning/stroke_places.hpp"
#include "mcmc/learning/velocity_modes.hpp"
#include "mcmc/simulation/edit_population.hpp"
#include "mcmc/simulation/rate_calibration.hpp"
#include "mcmc/simulation/rounding.hpp"
#include "mcmc/simulation/simulated_strokes.hpp"

namespace emberfold::mcmc {

namespace {

using graph::EventType;

constexpr double most_crowded = 4;  // births over deaths
constexpr double just_stable = 0.9999;
constexpr std::size_t placed = 600;  // exemplars of a painted birth map

double sum(const CellMap& map) {
  return std::accumulate(map.values.begin(), map.values.end(), 0.0);
}

void check(const char* field, double value, double least, double most) {
  if (value >= least && value <= most) return;
  const auto text = [](double v) {
    std::string s = std::to_string(v);
    s.erase(s.find_last_not_of('0') + 1);
    if (s.back() == '.') s.pop_back();
    return s;
  };
  throw core::InputError(std::string("MotionEdit.") + field + " is " + text(value) + ", must be in " +
                         text(least) + "…" + text(most));
}

// --- speed

double power(double share, double factor) {
  return 1 - std::pow(1 - std::clamp(share, 0.0, 1.0), factor);
}

// Resamples shares at `factor` times the speed, or as slowly as the whole rise fits into the frames.
void resample_fade(std::array<double, 8>& shares, double factor) {
  double rising = 0;  // frames until it is all there
  for (std::size_t k = 0; k < shares.size(); ++k)
    if (shares[k] < 0.95) rising = static_cast<double>(k) + 1;
  const double step = std::max(factor, rising / static_cast<double>(shares.size()));
  const auto was = shares;
  for (std::size_t k = 0; k < shares.size(); ++k) {
    const double x = static_cast<double>(k) * step;
    const auto i = static_cast<std::size_t>(x);
    const auto at = [&](std::size_t j) { return j < was.size() ? was[j] : 1.0; };
    shares[k] = at(i) + (x - static_cast<double>(i)) * (at(i + 1) - at(i));
  }
}

void speed_up(MotionModel& model, double factor, std::uint64_t seed, const core::Context& context) {
  EventStatistics shown = detail::measure_event_statistics(model, seed, context);
  for (double& events : shown.events) events *= factor;
  for (Autoregression* motion : {&model.displacement, &model.contrast}) {
    *motion = change_speed(*motion, factor);
    for (double* value : {&motion->a1, &motion->a2, &motion->coupling, &motion->noise})
      *value = detail::rounded(*value);
  }
  for (auto* map : {&model.drift_x, &model.drift_y, &model.rates.birth})
    for (double& value : map->values) value *= factor;
  auto& rates = model.rates;
  for (double& rate : rates.death_by_size) rate = power(rate, factor);
  for (double* rate : {&rates.split, &rates.merge, &rates.connect, &rates.disconnect})
    *rate = power(*rate, factor);
  rates.refractory_period /= factor, rates.modifiers.pace *= factor;
  resample_fade(model.appearing, factor);
  resample_fade(model.vanishing, factor);
  calibrate_rates(model, shown, seed, context);
}

// --- reversal

// Exchanges the maps of births and deaths.
void swap_maps(MotionModel& model) {
  auto& rates = model.rates;
  const double mean = sum(model.density) / static_cast<double>(model.density.values.size());
  CellMap ends = rates.death, begins = rates.birth;
  double weight = 0, level = 0;
  for (std::size_t c = 0; c < ends.values.size(); ++c) {
    const double there = model.density.values[c] + 0.1 * mean;
    ends.values[c] *= there;
    begins.values[c] /= std::max(there, 1e-12);
    weight += there, level += there * begins.values[c];
  }
  if (level > 0)
    for (double& value : begins.values) value *= weight / level;
  rates.birth = ends;
  if (level > 0) rates.death = begins;
}

// Notes numbers that were not reached. Unions need strokes near each other, so not every number of
// separations can be reversed.
void note_unmet(const EventStatistics& wanted, EditedMotion& result, std::uint64_t seed,
                const core::Context& context) {
  const EventStatistics seen = detail::measure_event_statistics(result.model, seed, context);
  for (std::size_t i = 0; i < wanted.events.size(); ++i)
    if (std::abs(seen.events[i] - wanted.events[i]) > 0.25 * wanted.events[i] + 0.05)
      result.notes.push_back("backwards " + std::to_string(seen.events[i]) + " " +
                             std::string(graph::name(static_cast<EventType>(i))) +
                             " events a frame could be had, " + std::to_string(wanted.events[i]) +
                             " were wanted");
}

void reverse_time(EditedMotion& result, std::uint64_t seed, const core::Context& context) {
  MotionModel& model = result.model;
  EventStatistics shown = detail::measure_event_statistics(model, seed, context);
  auto& rates = model.rates;
  const auto born = births_by_size(model);
  std::array<double, kSizeClasses> dying{};
  double deaths = 0;
  for (std::size_t s = 0; s < kSizeClasses; ++s)
    deaths += dying[s] = rates.death_by_size[s] * shown.strokes[s];
  for (std::size_t s = 0; s < kSizeClasses; ++s) {
    const double rate = shown.strokes[s] > 0 ? born[s] / shown.strokes[s] : rates.death_by_size[s];
    rates.death_by_size[s] = std::min(1.0, rate);
  }
  swap_maps(model);
  const auto at = [&](EventType type) -> double& { return shown.events[static_cast<std::size_t>(type)]; };
  if (deaths > 0)
    for (double& value : dying) value *= at(EventType::death) / deaths;
  set_births(model, dying, shown.strokes);
  // Unions become as frequent as separations were; an event that was never observed starts with the other's
  // rate.
  const auto exchange = [&](EventType a, EventType b, double& rate_a, double& rate_b) {
    const double turned_a = at(a) > 0 ? rate_a * at(b) / at(a) : rate_b;
    rate_b = std::min(1.0, at(b) > 0 ? rate_b * at(a) / at(b) : rate_a);
    rate_a = std::min(1.0, turned_a);
    std::swap(at(a), at(b));
  };
  exchange(EventType::split, EventType::merge, rates.split, rates.merge);
  exchange(EventType::disconnect, EventType::connect, rates.disconnect, rates.connect);
  std::swap(at(EventType::birth), at(EventType::death));
  for (auto* map : {&model.drift_x, &model.drift_y})
    for (double& value : map->values) value = -value;
  model.velocity = reverse_modes(std::move(model.velocity));
  std::swap(model.appearing, model.vanishing);
  calibrate_rates(model, shown, seed, context);
  note_unmet(shown, result, seed, context);
}

// --- a choice of strokes

double coarseness(const graph::AttributeGraph& graph) {
  double all = 0;
  for (const auto& vertex : graph.vertices()) all += vertex.patch.width + 2 * vertex.patch.blur;
  return all / static_cast<double>(graph.size());
}

// Coarseness that halves the exemplars' patches.
double mean_coarseness(const MotionModel& model) {
  std::vector<std::pair<double, std::size_t>> strokes;
  std::size_t patches = 0;
  for (const auto& exemplar : model.exemplars) {
    strokes.emplace_back(coarseness(exemplar.graph), exemplar.graph.size());
    patches += exemplar.graph.size();
  }
  std::ranges::sort(strokes);
  std::size_t below = 0;
  for (const auto& [value, size] : strokes)
    if ((below += size) * 2 >= patches) return value;
  return 0;
}

graph::AttributeGraph stroke(const graph::AttributeGraph& graph, const std::vector<std::uint32_t>& part) {
  std::vector<graph::Vertex> vertices;
  for (const auto v : part) vertices.push_back(graph.vertices()[v]);
  return {std::move(vertices), {}};
}

// Keeps the first frame's strokes that `keep` accepts.
template <class Keep>
void keep_first(MotionModel& model, const Keep& keep) {
  const auto& graph = model.first;
  std::vector<bool> kept(graph.size());
  for (const auto& part : vertices_by_stroke(graph::components(graph)))
    for (const auto v : part) kept[v] = keep(stroke(graph, part));
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  for (std::uint32_t v = 0; v < graph.size(); ++v)
    if (kept[v]) vertices.push_back(graph.vertices()[v]);
  for (const auto& edge : graph.edges())
    if (kept[graph.index_of(edge.a)]) edges.push_back(edge);
  model.first = {std::move(vertices), std::move(edges)};
}

// Returns the share of births that is left.
double choose_strokes(MotionModel& model, StrokeChoice choice) {
  const double usual = mean_coarseness(model);
  const auto keep = [&](const graph::AttributeGraph& graph) {
    return (coarseness(graph) > usual) == (choice == StrokeChoice::coarse);
  };
  std::array<double, kSizeClasses> all{}, left{};
  std::vector<Exemplar> exemplars;
  for (const auto& exemplar : model.exemplars) {
    const auto size = size_class(exemplar.graph.size());
    ++all[size];
    if (!keep(exemplar.graph)) continue;
    ++left[size];
    exemplars.push_back(exemplar);
  }
  if (exemplars.empty())
    throw core::InputError("MotionEdit.strokes: the model's strokes are all alike; none would be left");
  auto births = births_by_size(model);
  const double before = std::accumulate(births.begin(), births.end(), 0.0);
  for (std::size_t s = 0; s < kSizeClasses; ++s) births[s] *= all[s] > 0 ? left[s] / all[s] : 0;
  set_births(model, births, left);
  model.exemplars = std::move(exemplars);
  keep_first(model, keep);
  for (double& value : model.density.values) value /= 2;
  return before > 0 ? std::accumulate(births.begin(), births.end(), 0.0) / before : 1;
}

// --- places of births

// Lets strokes be born by this map: each exemplar at some places drawn from it.
void place_exemplars(MotionModel& model, const CellMap& map, std::uint64_t seed) {
  std::vector<Exemplar> exemplars;
  const std::size_t copies =
      std::max<std::size_t>(1, placed / std::max<std::size_t>(1, model.exemplars.size()));
  for (std::size_t i = 0; i < model.exemplars.size(); ++i)
    for (std::size_t copy = 0; copy < copies; ++copy) {
      core::Rng rng(seed, {static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(copy), 0});
      Exemplar one = model.exemplars[i];
      one.place = draw_place(map, rng);
      exemplars.push_back(std::move(one));
    }
  model.exemplars = std::move(exemplars);
}

void apply_birth_map(MotionModel& model, const CellMap& painted, std::uint64_t seed) {
  auto& birth = model.rates.birth;
  if (painted.columns != birth.columns || painted.rows != birth.rows || painted.cell != birth.cell ||
      painted.values.size() != birth.values.size())
    throw core::InputError("MotionEdit.birth_map is of another grid than the model's");
  const double whole = sum(birth), mass = sum(painted);
  for (std::size_t c = 0; c < birth.values.size(); ++c) birth.values[c] = painted.values[c] / mass * whole;
  place_exemplars(model, painted, seed);
}

// Lets all strokes drift. Returns how many it carries out of the frame, of `strokes` evenly spread ones.
double add_wind(MotionModel& model, graph::Point wind, double strokes) {
  for (double& value : model.drift_x.values) value += wind.x;
  for (double& value : model.drift_y.values) value += wind.y;
  return strokes * (std::abs(wind.x) / model.width + std::abs(wind.y) / model.height);
}

// Lets as many strokes be born at the side where the wind comes from as it brings in, of evenly spread ones.
void bring_in(MotionModel& model, graph::Point wind, double strokes, std::uint64_t seed) {
  auto& birth = model.rates.birth;
  const double density = strokes / (double(model.width) * model.height);  // a px²
  const int column = wind.x > 0 ? 0 : birth.columns - 1, row = wind.y > 0 ? 0 : birth.rows - 1;
  std::size_t cell = 0;
  for (int y = 0; y < birth.rows; ++y)
    for (int x = 0; x < birth.columns; ++x) {
      const double brought = (x == column ? std::abs(wind.x) : 0) + (y == row ? std::abs(wind.y) : 0);
      birth.values[cell++] += density * brought / birth.cell;
    }
  place_exemplars(model, birth, seed);
}

// --- contrast

graph::AttributeGraph with_contrast(const graph::AttributeGraph& graph, double factor) {
  std::vector<graph::Vertex> vertices(graph.vertices().begin(), graph.vertices().end());
  for (auto& vertex : vertices) detail::scale_contrast(vertex.patch, factor);
  return {std::move(vertices), {graph.edges().begin(), graph.edges().end()}};
}

void change_contrast(MotionModel& model, double factor) {
  model.first = with_contrast(model.first, factor);
  for (auto& exemplar : model.exemplars) exemplar.graph = with_contrast(exemplar.graph, factor);
}

// --- rates

void change_population(EditedMotion& result, const MotionEdit& edit, std::uint64_t seed,
                       const core::Context& context) {
  MotionModel& model = result.model;
  const EventStatistics shown = detail::measure_event_statistics(model, seed, context);
  detail::TargetEvents wanted;
  double births = edit.rates[0];
  if (edit.strokes != StrokeChoice::all) births *= choose_strokes(model, edit.strokes);
  if (edit.birth_map) apply_birth_map(model, *edit.birth_map, seed);
  const double strokes = std::accumulate(shown.strokes.begin(), shown.strokes.end(), 0.0);
  double carried = 0;  // strokes a frame, out of the frame and into it
  if (edit.wind != graph::Point{}) carried = add_wind(model, edit.wind, strokes);
  if (births <= 0) carried = 0;  // none is wanted
  auto& rates = model.rates;
  const auto scale = [&](EventType type, double factor, auto&&... rate) {
    const auto i = static_cast<std::size_t>(type);
    if (edit.rates[i] == 1) return;
    wanted[i] = factor * shown.events[i];
    ((rate = std::min(1.0, rate * factor)), ...);
  };
  for (double& value : rates.birth.values) value *= edit.rates[0];
  if (carried > 0 && !edit.birth_map) bring_in(model, edit.wind, strokes, seed);
  if (births != 1 || edit.birth_map || carried > 0) wanted[0] = births * shown.events[0] + carried;
  for (double& rate : rates.death_by_size) scale(EventType::death, edit.rates[1], rate);
  scale(EventType::split, edit.rates[2], rates.split);
  scale(EventType::merge, edit.rates[3], rates.merge);
  scale(EventType::connect, edit.rates[4], rates.connect);
  scale(EventType::disconnect, edit.rates[5], rates.disconnect);
  if (births <= 0 || (shown.events[0] <= 0 && carried <= 0)) {
    if (edit.rates[0] <= 0) result.notes.emplace_back("nothing is born: what is there first dies out");
    return;
  }
  auto notes = detail::calibrate_population(model, wanted, seed, context);
  std::ranges::move(notes, std::back_inserter(result.notes));
}

}  // namespace

void MotionEdit::validate() const {
  check("speed", speed, 0.1, 10);
  check("intensity", intensity, 0, 10);
  check("flicker", flicker, 0, 10);
  check("contrast", contrast, 0.1, 10);
  for (const double speed_of_wind : {wind.x, wind.y}) check("wind", speed_of_wind, -8, 8);
  constexpr std::array names = {"births", "deaths", "splits", "merges", "connects", "disconnects"};
  for (std::size_t i = 0; i < rates.size(); ++i) check(names[i], rates[i], 0, 10);
  if (rates[0] > most_crowded * rates[1])
    throw core::InputError("MotionEdit.births is " + std::to_string(rates[0]) + " at deaths of " +
                           std::to_string(rates[1]) +
                           ", must be at most 4 times the deaths: the frame would fill up");
  if (!birth_map) return;
  for (const double value : birth_map->values) check("birth_map", value, 0, 1e9);
  if (!(sum(*birth_map) > 0))
    throw core::InputError("MotionEdit.birth_map is empty: nothing is painted in it");
}

Autoregression change_speed(const Autoregression& motion, double factor) {
  const double deviation = stationary_deviation(motion);
  const std::complex<double> root = std::sqrt(std::complex<double>(motion.a1 * motion.a1 + 4 * motion.a2, 0));
  const auto power = [factor](std::complex<double> pole) -> std::complex<double> {
    if (pole == 0.0) return 0;
    if (pole.imag() == 0) return std::copysign(std::pow(std::abs(pole.real()), factor), pole.real());
    return std::polar(std::pow(std::abs(pole), factor), std::arg(pole) * factor);
  };
  const auto one = power((motion.a1 + root) / 2.0), other = power((motion.a1 - root) / 2.0);
  Autoregression result = motion;
  result.a1 = (one + other).real(), result.a2 = -(one * other).real();
  result.coupling = 1 - std::pow(1 - motion.coupling, factor);
  while (result.coupling > 0 && spectral_radius(result) > just_stable)
    result.coupling = result.coupling > 1e-6 ? result.coupling / 2 : 0;
  if (motion.noise > 0) result.noise *= deviation / stationary_deviation(result);
  return result;
}

EditedMotion edit_motion(const MotionModel& model, const MotionEdit& edit, std::uint64_t seed,
                         const core::Context& context) {
  validate(model);
  edit.validate();
  EditedMotion result{model, {}};
  if (edit.speed != 1) speed_up(result.model, edit.speed, seed, context);
  if (edit.reverse) reverse_time(result, seed, context);
  result.model.displacement.noise *= edit.intensity;
  for (double& value : result.model.velocity.modes) value *= edit.intensity;
  result.model.contrast.noise *= edit.flicker;
  const bool same_rates = std::ranges::all_of(edit.rates, [](double rate) { return rate == 1; });
  if (edit.contrast != 1) change_contrast(result.model, edit.contrast);
  const bool is_still = edit.wind == graph::Point{};
  if (!same_rates || !is_still || edit.birth_map || edit.strokes != StrokeChoice::all)
    change_population(result, edit, seed, context);
  validate(result.model);
  return result;
}

}  // namespace emberfold::mcmc
