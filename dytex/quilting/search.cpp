// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "core/rng.hpp"

namespace emberfold::dytex::detail {

namespace {

constexpr float kForbidden = std::numeric_limits<float>::infinity();  // bound of a forbidden place
constexpr double kNoLimit = std::numeric_limits<double>::max();
constexpr std::size_t kComparedTogether = 64;  // places; after each group the limit is lowered

bool earlier(const SourcePixel& a, const SourcePixel& b) {
  return std::tie(a.source, a.y, a.x) < std::tie(b.source, b.y, b.x);
}

}  // namespace

BlockSearch::BlockSearch(std::span<const QuiltSource> sources, const QuiltOptions& options, cv::Size least,
                         cv::Size most, const core::Context& context)
    : sources_(sources), options_(options), context_(context), prepared_(sources.size()) {
  for (const auto& source : sources) courses_.push_back(source.trajectories);
  for (std::size_t i = 0; i < sources.size(); ++i)
    if (!sources[i].forbidden.empty())
      cv::integral(sources[i].forbidden != 0, prepared_[i].forbidden, CV_64F);
  if (options.exact) return;
  const Basis basis = fit_basis(courses_, options.components, options.seed);
  components_ = basis.complete ? 0 : static_cast<int>(basis.directions.cols());
  auto planes = project_trajectories(courses_, basis, context);
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const cv::Size size = sources[i].trajectories->size();
    if (size.width < least.width || size.height < least.height) continue;
    const cv::Size largest(std::min(most.width, size.width), std::min(most.height, size.height));
    prepared_[i].features.emplace(planes[i], least, largest);
    prepared_[i].planes = std::move(planes[i]);
    if (!sources[i].guide.empty())
      prepared_[i].guide.emplace(std::vector<cv::Mat>{sources[i].guide}, least, largest);
  }
}

Overlap BlockSearch::overlap(const BlockQuery& query) const {
  return {courses_, query.runs, query.there};
}

BlockSearch::Scale BlockSearch::scale_of(const BlockQuery& query) const {
  const auto& info = courses_.front()->info();
  const double white = info.white / 255;
  const double values = static_cast<double>(query.there.size()) *
                        static_cast<double>(courses_.front()->dimension()) * white * white;
  Scale scale;
  scale.floor = options_.floor * options_.floor * values;
  if (query.guide.empty()) return scale;
  // Both as means of squared levels, so that the weight means the same for any overlap and length.
  const double area = query.block.place.area(), weight = options_.guide_weight / (1 - options_.guide_weight);
  scale.guide = query.there.empty() ? 1 : weight * values / area;
  scale.floor += scale.guide * options_.floor * options_.floor * area;
  return scale;
}

// 1 where a block may be taken from, else 0.
cv::Mat BlockSearch::allowed(std::size_t source, cv::Size block) const {
  const cv::Size size = courses_[source]->size();
  if (size.width < block.width || size.height < block.height) return {};
  cv::Mat mask(size.height - block.height + 1, size.width - block.width + 1, CV_8U, cv::Scalar(1));
  if (!prepared_[source].forbidden.empty())
    mask.setTo(0, box_sums(prepared_[source].forbidden, {{{}, block}}, block) > 0.5);
  return mask;
}

std::vector<cv::Mat> BlockSearch::feature_query(const BlockQuery& query) const {
  std::vector<cv::Mat> planes(prepared_.front().planes.size());
  for (const auto& prepared : prepared_) planes.resize(std::max(planes.size(), prepared.planes.size()));
  for (auto& plane : planes) plane = cv::Mat::zeros(query.block.place.size(), CV_32F);
  std::size_t i = 0;
  for (const Run& run : query.runs)
    for (int x = run.x; x < run.x + run.length; ++x, ++i) {
      const SourcePixel& from = query.there[i];
      const auto& source = prepared_[static_cast<std::size_t>(from.source)].planes;
      for (std::size_t p = 0; p < planes.size(); ++p)
        planes[p].at<float>(run.y, x) = source[p].at<float>(from.y, from.x);
    }
  return planes;
}

cv::Mat BlockSearch::lower_bounds(std::size_t source, const BlockQuery& query, const Scale& scale) const {
  const Prepared& prepared = prepared_[source];
  const cv::Size block = query.block.place.size();
  const cv::Mat mask = allowed(source, block);
  if (mask.empty()) return {};
  cv::Mat bounds = cv::Mat::zeros(mask.size(), CV_32F);
  if (!options_.exact) {
    double margin = 0;
    if (!query.there.empty()) {
      const auto wanted = feature_query(query);
      bounds = prepared.features->squared_differences(wanted, run_boxes(query.runs));
      margin = prepared.features->margin(wanted);
    }
    if (scale.guide > 0) {
      const std::vector<cv::Mat> wanted{query.guide};
      bounds += scale.guide * prepared.guide->squared_differences(wanted, {{{}, block}});
      margin += scale.guide * prepared.guide->margin(wanted);
    }
    bounds -= margin;
  }
  bounds.setTo(kForbidden, mask == 0);
  return bounds;
}

double BlockSearch::guide_error(const BlockQuery& query, const SourcePixel& at) const {
  if (query.guide.empty()) return 0;
  const cv::Mat there =
      sources_[static_cast<std::size_t>(at.source)].guide({{at.x, at.y}, query.guide.size()});
  return cv::norm(there, query.guide, cv::NORM_L2SQR);
}

namespace {

// Copies `bounds` without the places nearer than `apart` to one of `near`; none where none remains.
std::vector<cv::Mat> without_near(const std::vector<cv::Mat>& bounds, const std::vector<SourcePixel>& near,
                                  int apart) {
  std::vector<cv::Mat> left;
  bool any = false;
  for (std::size_t s = 0; s < bounds.size(); ++s) {
    left.push_back(bounds[s].clone());
    const cv::Rect whole({}, bounds[s].size());
    for (const auto& place : near)
      if (place.source == static_cast<int>(s))
        left.back()(cv::Rect(place.x - apart + 1, place.y - apart + 1, 2 * apart - 1, 2 * apart - 1) & whole)
            .setTo(kForbidden);
    any = any || (!whole.empty() && cv::countNonZero(left.back() < kForbidden) > 0);
  }
  return any ? left : std::vector<cv::Mat>{};
}

}  // namespace

QuiltChoice BlockSearch::choose(const BlockQuery& query) const {
  const Scale scale = scale_of(query);
  std::vector<cv::Mat> bounds;
  for (std::size_t s = 0; s < sources_.size(); ++s) bounds.push_back(lower_bounds(s, query, scale));
  // A source that is too small for that gets a smaller distance from earlier places.
  for (int apart = query.near.empty() ? 0 : options_.apart; apart > 0; apart /= 2)
    if (auto left = without_near(bounds, query.near, apart); !left.empty()) {
      bounds = std::move(left);
      break;
    }
  QuiltChoice choice = pick(query, bounds, scale);
  choice.column = query.block.column;
  choice.row = query.block.row;
  return choice;
}

QuiltChoice BlockSearch::pick(const BlockQuery& query, std::vector<cv::Mat>& bounds,
                              const Scale& scale) const {
  core::Rng rng(options_.seed, {0x626cu, static_cast<std::uint32_t>(query.block.column),
                                static_cast<std::uint32_t>(query.block.row)});
  const auto gather = [&](double most) {
    std::vector<Candidate> found;
    for (std::size_t s = 0; s < bounds.size(); ++s)
      for (int y = 0; y < bounds[s].rows; ++y) {
        const auto* row = bounds[s].ptr<float>(y);
        for (int x = 0; x < bounds[s].cols; ++x)
          if (row[x] < kForbidden && static_cast<double>(row[x]) <= most)
            found.push_back({static_cast<double>(row[x]), {static_cast<int>(s), x, y}});
      }
    return found;
  };
  QuiltChoice choice;
  if (query.there.empty() && query.guide.empty()) {  // the first block: anything
    const auto all = gather(kNoLimit);
    choice.equals = static_cast<std::int64_t>(all.size());
    choice.at = all[rng.below(static_cast<std::uint32_t>(all.size()))].at;
    return choice;
  }
  const Overlap overlap = this->overlap(query);
  std::vector<std::pair<double, SourcePixel>> errors;
  double best = kNoLimit;
  const auto limit = [&] { return std::max((1 + options_.tolerance) * best, scale.floor); };
  const auto compare = [&](std::span<const Candidate> some) {
    std::vector<SourcePixel> places;
    for (const auto& candidate : some) places.push_back(candidate.at);
    const auto differences = overlap.errors(places, best == kNoLimit ? kNoLimit : limit());
    for (std::size_t i = 0; i < some.size(); ++i) {
      const double guide = scale.guide > 0 ? scale.guide * guide_error(query, places[i]) : 0;
      errors.emplace_back(differences[i] + guide, places[i]);
      best = std::min(best, errors.back().first);
    }
  };
  // The place with the lowest bound limits which others need comparing.
  Candidate first{kNoLimit, {}};
  for (std::size_t s = 0; s < bounds.size(); ++s) {
    if (bounds[s].empty()) continue;
    double least = 0;
    cv::Point place;
    cv::minMaxLoc(bounds[s], &least, nullptr, &place);
    if (least < first.lower) first = {least, {static_cast<int>(s), place.x, place.y}};
  }
  compare({&first, 1});
  auto candidates = gather(limit());
  std::erase_if(candidates, [&](const Candidate& c) { return c.at == first.at; });
  std::ranges::sort(candidates, [](const Candidate& a, const Candidate& b) {
    return a.lower != b.lower ? a.lower < b.lower : earlier(a.at, b.at);
  });
  for (std::size_t i = 0; i < candidates.size() && candidates[i].lower <= limit(); i += kComparedTogether) {
    context_.check();  // where no two places are similar all have to be compared
    compare(std::span(candidates).subspan(i, std::min(kComparedTogether, candidates.size() - i)));
  }
  choice.compared = static_cast<std::int64_t>(errors.size());
  std::erase_if(errors, [&](const auto& one) { return one.first > limit(); });
  std::ranges::sort(errors, [](const auto& a, const auto& b) { return earlier(a.second, b.second); });
  const auto drawn = rng.below(static_cast<std::uint32_t>(errors.size()));
  choice.equals = static_cast<std::int64_t>(errors.size());
  std::tie(choice.error, choice.at) = errors[drawn];
  return choice;
}

}  // namespace emberfold::dytex::detail
