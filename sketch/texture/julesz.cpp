// SPDX-License-Identifier: Apache-2.0
#include "sketch/texture/julesz.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <sstream>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "core/clip.hpp"
#include "core/error.hpp"
#include "core/rng.hpp"
#include "core/text/check_range.hpp"

namespace emberfold::sketch {

namespace {

constexpr std::uint8_t kNoBin = 255;  // of a response that does not count
constexpr std::size_t kLanes = 8;     // responses side by side, for the vector unit
constexpr int kMargin = 3;            // px around the frame, the largest radius
constexpr std::int16_t kTop = std::numeric_limits<std::int16_t>::max();  // above any response
constexpr int kPhases = 4;  // px between pixels visited one after the other

void check(const cv::Mat& start, const TextureRegions& regions) {
  std::ostringstream message;
  const auto count = 2 * static_cast<std::size_t>(std::max(regions.count, 0));
  double highest = 0;
  if (start.dims != 2 || start.empty() || start.depth() != CV_32F ||
      (start.channels() != 1 && start.channels() != 3))
    message << "julesz: levels are " << cv::typeToString(start.type()) << ", " << start.cols << " × "
            << start.rows << "; allowed are CV_32FC1 and CV_32FC3 of at least 1 × 1";
  else if (regions.part.dims != 2 || regions.part.type() != CV_8UC1 || regions.part.size() != start.size())
    message << "julesz: the parts are " << cv::typeToString(regions.part.type()) << ", " << regions.part.cols
            << " × " << regions.part.rows << "; they have to be CV_8UC1 of the levels' size, " << start.cols
            << " × " << start.rows;
  else if (!cv::checkRange(start))
    message << "julesz: the levels hold a number that is not finite";
  else if (cv::minMaxLoc(regions.part, nullptr, &highest); highest > static_cast<double>(count) ||
                                                           regions.histograms.size() != count ||
                                                           regions.edges.size() != count)
    message << "julesz: there are parts up to " << highest << ", " << regions.histograms.size()
            << " histograms and edges of " << regions.edges.size() << " for " << regions.count
            << " regions of two parts; each part needs its own";
  if (!message.str().empty()) throw core::InputError(message.str());
}

class Sampler {
 public:
  Sampler(const cv::Mat& bytes, const TextureRegions& regions);
  void sweep(std::uint64_t seed, std::uint32_t number, double temperature);
  [[nodiscard]] double distance() const;
  [[nodiscard]] int level(int y, int x) const { return level_[place(y, x)]; }

 private:
  /// Weights with which a pixel takes part in responses side by side.
  struct Row {
    std::ptrdiff_t offset;  // from the pixel to the first response
    std::array<std::int16_t, kLanes> weights;
  };
  using Rows = std::array<std::vector<Row>, kTextureFilters>;
  struct Filter {
    std::vector<std::int16_t> responses;
    std::vector<std::int16_t> low, end;  // the bin's limits: low ≤ response < end
    std::vector<std::uint8_t> bins;
  };
  struct Move {
    std::size_t filter, place;
    std::uint8_t bin;
  };
  /// The lowest response of each bin, and one above the highest of the last.
  using Limits = std::array<std::int16_t, kTextureBins + 1>;

  [[nodiscard]] std::size_t place(int y, int x) const {
    return static_cast<std::size_t>(y + kMargin) * stride_ + static_cast<std::size_t>(x + kMargin);
  }
  [[nodiscard]] std::size_t cell(std::size_t at, std::size_t filter, std::size_t bin) const {
    return ((part_[at] - std::size_t{1}) * kTextureFilters + filter) * kTextureBins + bin;
  }
  [[nodiscard]] const Limits& limits(std::size_t at, std::size_t filter) const {
    return limits_[(part_[at] - std::size_t{1}) * kTextureFilters + filter];
  }
  void order_visits(const cv::Mat& part);
  void visit(const cv::Size& size, cv::Point pixel);
  void set_limits(const TextureRegions& regions);
  void count(const cv::Mat& bytes, const TextureRegions& regions);
  [[nodiscard]] Rows rows_of(const cv::Size& size, cv::Point pixel) const;
  double propose(std::size_t at, const Rows& rows, int change);
  void move(std::size_t filter, std::size_t to, int response);
  void accept(std::size_t at, const Rows& rows, int change);

  std::size_t stride_;
  std::vector<int> level_;
  std::vector<std::uint8_t> part_;
  struct Visit {
    std::size_t place, rows;
    std::uint32_t number;  // in the raster
  };
  std::vector<Visit> visits_;
  std::vector<Rows> rows_;  // first those of pixels inside, then of the border's one by one
  std::array<Filter, kTextureFilters> filters_;
  std::vector<Limits> limits_;             // by part and filter
  std::vector<std::array<int, 3>> reach_;  // by part: the largest change of three kinds of proposals
  std::vector<double> total_;              // by part and filter: responses that count
  std::vector<double> excess_;             // by part, filter and bin: n − n₀
  std::vector<double> stiffness_;          // of its square
  // Current proposal:
  std::vector<Move> moves_;
  std::vector<int> shift_;  // by part, filter and bin; 0 between proposals
  std::vector<std::size_t> shifted_;
};

Sampler::Sampler(const cv::Mat& bytes, const TextureRegions& regions)
    : stride_(static_cast<std::size_t>(bytes.cols + 2 * kMargin)) {
  const std::size_t places = stride_ * static_cast<std::size_t>(bytes.rows + 2 * kMargin);
  level_.assign(places, 0);
  part_.assign(places, 0);
  for (int y = 0; y < bytes.rows; ++y)
    for (int x = 0; x < bytes.cols; ++x) {
      level_[place(y, x)] = bytes.at<std::uint8_t>(y, x);
      part_[place(y, x)] = regions.part.at<std::uint8_t>(y, x);
    }
  // Rows of a pixel far from all borders.
  rows_.push_back(rows_of({4 * kMargin + 1, 4 * kMargin + 1}, {2 * kMargin, 2 * kMargin}));
  order_visits(regions.part);
  set_limits(regions);
  count(bytes, regions);
}

/// Neighbours are not visited one after the other: no direction is preferred.
void Sampler::order_visits(const cv::Mat& part) {
  constexpr std::array<int, kPhases> kOrder{0, 2, 1, 3};
  for (const int first_x : kOrder)
    for (const int first_y : kOrder)
      for (int y = first_y; y < part.rows; y += kPhases)
        for (int x = (first_x + first_y / 2) % kPhases; x < part.cols; x += kPhases)
          if (part.at<std::uint8_t>(y, x) != 0) visit(part.size(), {x, y});
}

void Sampler::visit(const cv::Size& size, cv::Point pixel) {
  const auto number = static_cast<std::uint32_t>(pixel.y * size.width + pixel.x);
  const bool inside = pixel.x > 0 && pixel.y > 0 && pixel.x < size.width - 1 && pixel.y < size.height - 1;
  if (!inside) rows_.push_back(rows_of(size, pixel));
  visits_.push_back({place(pixel.y, pixel.x), inside ? 0 : rows_.size() - 1, number});
}

/// A pixel of the border stands for those beyond it too.
Sampler::Rows Sampler::rows_of(const cv::Size& size, cv::Point pixel) const {
  Rows rows;
  const auto bank = make_texture_filters();
  for (std::size_t f = 0; f < bank.size(); ++f) {
    const int r = bank[f].radius;
    for (int y = std::max(0, pixel.y - r); y <= std::min(size.height - 1, pixel.y + r); ++y) {
      Row row{(y - pixel.y) * static_cast<std::ptrdiff_t>(stride_) - r, {}};
      for (int x = std::max(0, pixel.x - r); x <= std::min(size.width - 1, pixel.x + r); ++x)
        for (const auto& tap : bank[f].taps)
          if (std::clamp(x + tap.dx, 0, size.width - 1) == pixel.x &&
              std::clamp(y + tap.dy, 0, size.height - 1) == pixel.y) {
            auto& weight = row.weights[static_cast<std::size_t>(x - pixel.x + r)];
            weight = static_cast<std::int16_t>(weight + tap.weight);
          }
      rows[f].push_back(row);
    }
  }
  return rows;
}

void Sampler::set_limits(const TextureRegions& regions) {
  const auto bank = make_texture_filters();
  double power = 0;  // of the fine Laplacian: its response to white noise of SD 1, squared
  for (const auto& tap : bank[1].taps) power += tap.weight * tap.weight;
  for (const auto& edges : regions.edges) {
    for (const auto& of_filter : edges) {
      Limits limits{};
      limits.front() = std::numeric_limits<std::int16_t>::min();
      std::ranges::transform(of_filter, limits.begin() + 1, [&](int edge) {
        return static_cast<std::int16_t>(std::clamp<int>(edge, limits.front(), kTop));
      });
      limits.back() = kTop;
      limits_.push_back(limits);
    }
    // From 3 to 97 % of the fine Laplacian are four SD. Greater changes would make specks of what is to be
    // shade.
    const int fine = static_cast<int>((edges[1][9] - edges[1][2]) / (2 * std::sqrt(power)));
    reach_.push_back({std::clamp(fine / 4, 1, 128), std::clamp(fine / 2, 1, 128), std::clamp(fine, 2, 128)});
  }
}

void Sampler::count(const cv::Mat& bytes, const TextureRegions& regions) {
  const auto bank = make_texture_filters();
  const std::size_t pairs = limits_.size();
  total_.assign(pairs, 0.0);
  excess_.assign(pairs * kTextureBins, 0.0);
  for (std::size_t f = 0; f < bank.size(); ++f) {
    Filter& filter = filters_[f];
    const cv::Mat responses = filter_responses(bytes, bank[f]);
    filter.responses.assign(level_.size() + kLanes, 0);
    filter.low.assign(filter.responses.size(), std::numeric_limits<std::int16_t>::min());
    filter.end.assign(filter.responses.size(), kTop);
    filter.bins.assign(filter.responses.size(), kNoBin);
    for (int y = 0; y < bytes.rows; ++y)
      for (int x = 0; x < bytes.cols; ++x) {
        const std::size_t at = place(y, x);
        filter.responses[at] = static_cast<std::int16_t>(responses.at<int>(y, x));
        if (part_[at] == 0) continue;
        const auto& edges = regions.edges[part_[at] - std::size_t{1}][f];
        filter.bins[at] = static_cast<std::uint8_t>(find_bin(edges, filter.responses[at]));
        filter.low[at] = limits(at, f)[filter.bins[at]];
        filter.end[at] = limits(at, f)[filter.bins[at] + std::size_t{1}];
        ++excess_[cell(at, f, filter.bins[at])];
        ++total_[cell(at, f, 0) / kTextureBins];
      }
  }
  stiffness_.resize(excess_.size());
  for (std::size_t i = 0; i < excess_.size(); ++i) {
    const std::size_t pair = i / kTextureBins;
    const double asked =
        total_[pair] * regions.histograms[pair / kTextureFilters][pair % kTextureFilters][i % kTextureBins];
    excess_[i] -= asked;
    stiffness_[i] = 1 / (asked + 0.5 + total_[pair] / 1000);
  }
  shift_.assign(excess_.size(), 0);
}

/// Returns the rise of the energy; stores the moves between bins.
double Sampler::propose(std::size_t at, const Rows& rows, int change) {
  moves_.clear();
  shifted_.clear();
  const auto factor = static_cast<std::int16_t>(change);
  for (std::size_t f = 0; f < filters_.size(); ++f)
    for (const Row& row : rows[f]) {
      const std::size_t first = at + static_cast<std::size_t>(row.offset);
      const std::int16_t *now = &filters_[f].responses[first], *low = &filters_[f].low[first],
                         *end = &filters_[f].end[first];
      std::array<std::int16_t, kLanes> next;
      std::int16_t leaves = 0;
      for (std::size_t i = 0; i < kLanes; ++i) {
        next[i] = static_cast<std::int16_t>(now[i] + factor * row.weights[i]);
        leaves = static_cast<std::int16_t>(leaves | -static_cast<int>(next[i] < low[i]) |
                                           -static_cast<int>(next[i] >= end[i]));
      }
      if (leaves == 0) continue;
      for (std::size_t i = 0; i < kLanes; ++i)
        if (next[i] < low[i] || next[i] >= end[i]) move(f, first + i, next[i]);
    }
  double rise = 0;
  for (const std::size_t i : shifted_) {  // a cell may be there twice: the second time it has no shift left
    const double shift = shift_[i];
    rise += stiffness_[i] * shift * (2 * excess_[i] + shift);
    shift_[i] = 0;
  }
  return rise;
}

void Sampler::move(std::size_t filter, std::size_t to, int response) {
  const std::uint8_t bin = filters_[filter].bins[to];
  if (bin == kNoBin) return;
  const Limits& bounds = limits(to, filter);
  std::uint8_t next = bin;
  while (response < bounds[next]) --next;
  while (response >= bounds[next + std::size_t{1}]) ++next;
  moves_.push_back({filter, to, next});
  shifted_.push_back(cell(to, filter, bin));
  shifted_.push_back(cell(to, filter, next));
  --shift_[*(shifted_.end() - 2)];
  ++shift_[shifted_.back()];
}

void Sampler::accept(std::size_t at, const Rows& rows, int change) {
  level_[at] += change;
  const auto factor = static_cast<std::int16_t>(change);
  for (std::size_t f = 0; f < filters_.size(); ++f)
    for (const Row& row : rows[f]) {
      std::int16_t* now = &filters_[f].responses[at + static_cast<std::size_t>(row.offset)];
      for (std::size_t i = 0; i < kLanes; ++i)
        now[i] = static_cast<std::int16_t>(now[i] + factor * row.weights[i]);
    }
  for (const Move& to : moves_) {
    Filter& filter = filters_[to.filter];
    --excess_[cell(to.place, to.filter, filter.bins[to.place])];
    filter.bins[to.place] = to.bin;
    filter.low[to.place] = limits(to.place, to.filter)[to.bin];
    filter.end[to.place] = limits(to.place, to.filter)[to.bin + std::size_t{1}];
    ++excess_[cell(to.place, to.filter, to.bin)];
  }
}

void Sampler::sweep(std::uint64_t seed, std::uint32_t number, double temperature) {
  for (const auto& [at, own, pixel] : visits_) {
    core::Rng rng(seed, {number, pixel});
    const std::uint32_t bits = rng.bits();
    // As likely as the way back.
    const auto& reaches = reach_[part_[at] - std::size_t{1}];
    const auto reach = static_cast<unsigned>(reaches[(bits >> 1) % reaches.size()]);
    const int size = 1 + static_cast<int>(rng.below(reach));
    const int change = (bits & 1U) != 0 ? size : -size;
    if (level_[at] + change < 0 || level_[at] + change > 255) continue;
    const double rise = propose(at, rows_[own], change);
    if (rise <= 0 || (rise < 40 * temperature && rng.uniform() < std::exp(-rise / temperature)))
      accept(at, rows_[own], change);
  }
}

double Sampler::distance() const {
  double apart = 0, all = 0;
  for (const double excess : excess_) apart += std::abs(excess);
  for (const double total : total_) all += total;
  return all > 0 ? apart / (2 * all) : 0;
}

/// The start with its free pixels' luma replaced.
cv::Mat with_luma(const cv::Mat& start, const cv::Mat& luma, const cv::Mat& part, const Sampler& sampler) {
  cv::Mat result = start.clone();
  const int channels = start.channels();
  for (int y = 0; y < start.rows; ++y)
    for (int x = 0; x < start.cols; ++x) {
      if (part.at<std::uint8_t>(y, x) == 0) continue;
      const auto level = static_cast<float>(sampler.level(y, x));
      float* pixel = result.ptr<float>(y) + x * channels;
      for (int c = 0; c < channels; ++c)
        pixel[c] = channels == 1 ? level : std::clamp(pixel[c] + level - luma.at<float>(y, x), 0.0F, 255.0F);
    }
  return result;
}

}  // namespace

void JuleszOptions::validate() const {
  core::check_range("JuleszOptions.sweeps", sweeps, 1, 10000);
  core::check_above("JuleszOptions.hottest", hottest, 0);
  core::check_above("JuleszOptions.coldest", coldest, 0, hottest);
}

JuleszResult julesz(const cv::Mat& start, const TextureRegions& regions, const JuleszOptions& options,
                    const core::Context& context) {
  options.validate();
  check(start, regions);
  const cv::Mat luma = core::luma(start);
  Sampler sampler(core::to_bytes(luma), regions);
  JuleszResult result;
  result.before = sampler.distance();
  for (int sweep = 0; sweep < options.sweeps; ++sweep) {
    context.check();
    const double way = options.sweeps > 1 ? double(sweep) / (options.sweeps - 1) : 1;
    sampler.sweep(options.seed, static_cast<std::uint32_t>(sweep),
                  options.hottest * std::pow(options.coldest / options.hottest, way));
    context.report("julesz", double(sweep + 1) / options.sweeps);
  }
  result.after = sampler.distance();
  result.levels = with_luma(start, luma, regions.part, sampler);
  return result;
}

}  // namespace emberfold::sketch
