// SPDX-License-Identifier: Apache-2.0
#include "sketch/refinement/pursuit.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/clip.hpp"
#include "sketch/inpainting/fill.hpp"
#include "sketch/patches/blob.hpp"
#include "sketch/patches/blob_shape.hpp"
#include "sketch/patches/patch_types.hpp"
#include "sketch/refinement/coding_length.hpp"
#include "sketch/rendering/render.hpp"

namespace emberfold::sketch {

using graph::AttributeGraph;
using graph::Curve;
using graph::Patch;
using graph::Vertex;

namespace {

constexpr int kRounds = 10;            // that spend a budget
constexpr double kLeastQuota = 0.02;   // of the frame's pixels a round
constexpr double kLocalMean = 6;       // px, SD: the first round's fill, that has nothing to hold on
constexpr double kStrokesFirst = 1.4;  // factor for curves, which also predict their continuation
constexpr double kMostHidden = 0.3;    // of a curve's pixels that others may show already

/// The pixels that something would show, and what.
struct Item {
  std::vector<std::uint32_t> pixels;  // row by row
  std::vector<float> values;          // luma
  double cost = 0;
  std::optional<Patch> blob;  // else a curve
  std::size_t curve = 0;
};

struct Offer {
  double score;  // nats a pixel
  Item* item;
};

/// The vertices of a curve and the edges along it.
AttributeGraph part_of(const AttributeGraph& graph, const Curve& curve, graph::Point origin) {
  std::vector<Vertex> vertices;
  std::vector<graph::Edge> edges;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const auto id = graph.vertices()[curve[i]].id;
    const bool again = i > 0 && curve[i] == curve.front();
    if (!again) {
      vertices.push_back(graph.vertices()[curve[i]]);
      vertices.back().patch.position = vertices.back().patch.position - origin;
    }
    if (i == 0) continue;
    const auto before = graph.vertices()[curve[i - 1]].id;
    edges.push_back({std::min(before, id), std::max(before, id)});
  }
  return {std::move(vertices), std::move(edges)};
}

cv::Rect curve_box(const AttributeGraph& graph, const Curve& curve, cv::Size size) {
  constexpr int kMargin = 16;  // px: a band's most reach and its curve's bulge
  double left = size.width, right = 0, top = size.height, bottom = 0;
  for (const auto v : curve) {
    const auto p = graph.patch(v).position;
    left = std::min(left, p.x), right = std::max(right, p.x);
    top = std::min(top, p.y), bottom = std::max(bottom, p.y);
  }
  const cv::Rect box(static_cast<int>(left) - kMargin, static_cast<int>(top) - kMargin,
                     static_cast<int>(right - left) + 2 * kMargin,
                     static_cast<int>(bottom - top) + 2 * kMargin);
  return box & cv::Rect({0, 0}, size);
}

/// Nats for the place where something begins: any of the frame's pixels.
double place_cost(cv::Size size) {
  return std::log(static_cast<double>(size.area()));
}

/// Draws a curve alone.
Item draw_curve(const AttributeGraph& graph, const std::vector<Curve>& curves, std::size_t number,
                cv::Size size) {
  Item item;
  item.curve = number;
  const cv::Rect box = curve_box(graph, curves[number], size);
  if (box.empty()) return item;
  const AttributeGraph part =
      part_of(graph, curves[number], {static_cast<double>(box.x), static_cast<double>(box.y)});
  const Sketchable drawn = draw_fitted(part, box.size(), 1);
  for (int y = 0; y < box.height; ++y)
    for (int x = 0; x < box.width; ++x)
      if (drawn.mask.at<std::uint8_t>(y, x) != 0) {
        item.pixels.push_back(static_cast<std::uint32_t>((box.y + y) * size.width + box.x + x));
        item.values.push_back(drawn.levels.at<float>(y, x));
      }
  item.cost = place_cost(size);
  for (const Vertex& v : part.vertices())
    item.cost +=
        coding_cost(v.patch, static_cast<double>(item.pixels.size()) / static_cast<double>(part.size()));
  return item;
}

class Pursuer {
 public:
  Pursuer(const AttributeGraph& proposals, const cv::Mat& levels, const PursuitOptions& pursuit)
      : proposals_(proposals),
        levels_(levels),
        luma_(core::luma(levels)),
        pursuit_(pursuit),
        curves_(graph::curves(proposals)),
        shown_(levels.size(), 0.0F),
        mask_(levels.size(), 0),
        error_(levels.size()) {
    for (std::size_t i = 0; i < curves_.size(); ++i)
      waiting_.push_back(draw_curve(proposals, curves_, i, luma_.size()));
  }

  AttributeGraph run() {
    const auto total = static_cast<double>(luma_.total());
    const double limit = pursuit_.budget * total;
    const double quota = std::max(limit / kRounds, kLeastQuota * total);
    for (double target = quota; taken_ < limit; target = taken_ + quota)
      if (!round(std::min(target, limit))) break;
    AttributeGraph result = assemble();
    // Together, curves show a little more than one by one: the last ones go again.
    while (!accepted_.empty() &&
           static_cast<double>(cv::countNonZero(draw_pixels(result, luma_).mask)) > limit) {
      accepted_.resize(accepted_.size() - std::max<std::size_t>(accepted_.size() / 100, 1));
      result = assemble();
    }
    return result;
  }

 private:
  /// Takes what gains most until `target` pixels are shown; whether anything did.
  bool round(double target) {
    measure_error();
    std::vector<Offer> offers;
    blobs_.clear();
    for (Item& item : waiting_)
      if (const double score = score_of(item); score > 0) offers.push_back({kStrokesFirst * score, &item});
    offer_blobs(offers);
    std::stable_sort(offers.begin(), offers.end(),
                     [](const Offer& a, const Offer& b) { return a.score > b.score; });
    fresh_ = cv::Mat1b(luma_.size(), 0);
    bool any = false;
    for (Offer& offer : offers) {
      if (taken_ + static_cast<double>(offer.item->pixels.size()) >
          pursuit_.budget * static_cast<double>(luma_.total()))
        continue;
      if (taken_ >= target) break;
      any = take(*offer.item) || any;
    }
    return any;
  }

  void measure_error() {
    cv::Mat filled;
    if (taken_ > 0)
      filled = fill(shown_, mask_).levels;
    else
      cv::GaussianBlur(luma_, filled, {}, kLocalMean, 0, cv::BORDER_REFLECT);
    cv::subtract(luma_, filled, error_);
    cv::multiply(error_, error_, error_);
  }

  /// Nats for each new pixel; 0 where it does not pay or too little of it would be new.
  double score_of(const Item& item) const {
    double saved = 0, fresh = 0;
    const float* luma = luma_.ptr<float>();
    const float* error = error_.ptr<float>();
    for (std::size_t i = 0; i < item.pixels.size(); ++i) {
      const std::uint32_t p = item.pixels[i];
      if (mask_.data[p] != 0) continue;
      const double off = double{luma[p]} - double{item.values[i]};
      saved += double{error[p]} - off * off;
      ++fresh;
    }
    const double all = static_cast<double>(item.pixels.size());
    if (fresh < (1 - kMostHidden) * all || fresh == 0) return 0;
    return (saved / (2 * pursuit_.noise * pursuit_.noise) - item.cost) / fresh;
  }

  void offer_blobs(std::vector<Offer>& offers) {
    for (const double reach : {1.5, 3.0, 6.0}) {
      cv::Mat1f sum;
      cv::GaussianBlur(error_, sum, {}, reach / 2, reach / 2, cv::BORDER_REFLECT);
      const auto least = static_cast<float>(2 * pursuit_.noise * pursuit_.noise);
      for (int y = 0; y < sum.rows; ++y)
        for (int x = 0; x < sum.cols; ++x)
          if (sum(y, x) >= least && mask_(y, x) == 0 && greatest(sum, x, y))
            offer_blob(offers, {x, y}, reach);
    }
  }

  static bool greatest(const cv::Mat1f& sum, int x, int y) {
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, sum.rows - 1); ++v)
      for (int u = std::max(x - 1, 0); u <= std::min(x + 1, sum.cols - 1); ++u)
        if (sum(v, u) > sum(y, x)) return false;
    return true;
  }

  void offer_blob(std::vector<Offer>& offers, cv::Point centre, double reach) {
    const int whole = static_cast<int>(std::ceil(reach));
    Item item;
    item.blob = fit_blob(luma_, centre, reach);
    const BlobShape shape(*item.blob);
    for (int y = std::max(centre.y - whole, 0); y <= std::min(centre.y + whole, luma_.rows - 1); ++y)
      for (int x = std::max(centre.x - whole, 0); x <= std::min(centre.x + whole, luma_.cols - 1); ++x) {
        const double dx = x - centre.x, dy = y - centre.y;
        if (!shape.holds(dx, dy)) continue;
        if (mask_(y, x) != 0) return;
        const auto shares = shape.at(dx, dy);
        item.pixels.push_back(static_cast<std::uint32_t>(y * luma_.cols + x));
        item.values.push_back(static_cast<float>(shares.left * double{item.blob->left[0]} +
                                                 shares.middle * double{item.blob->middle[0]} +
                                                 shares.right * double{item.blob->right[0]}));
      }
    item.cost = place_cost(luma_.size()) + coding_cost(*item.blob, static_cast<double>(item.pixels.size()));
    const double score = score_of(item);
    if (score <= 0) return;
    item.blob->cost = item.cost;
    item.blob->gain = score * static_cast<double>(item.pixels.size());
    blobs_.push_back(std::move(item));
    offers.push_back({score, &blobs_.back()});
  }

  /// Shows the item, unless one of this round is in its way.
  bool take(Item& item) {
    double met = 0;
    for (const std::uint32_t p : item.pixels) met += fresh_.data[p] != 0 ? 1 : 0;
    if (item.blob ? met > 0 : met > kMostHidden * static_cast<double>(item.pixels.size())) return false;
    for (std::size_t i = 0; i < item.pixels.size(); ++i) {
      const std::uint32_t p = item.pixels[i];
      fresh_.data[p] = 255;
      if (mask_.data[p] != 0) continue;
      mask_.data[p] = 255;
      shown_.ptr<float>()[p] = item.values[i];
      ++taken_;
    }
    if (item.blob) item.blob = in_colour(*item.blob);
    accepted_.push_back({{}, {}, item.cost, item.blob, item.curve});
    item.pixels.clear();
    return true;
  }

  /// Blobs are chosen by their luma.
  [[nodiscard]] Patch in_colour(const Patch& chosen) const {
    const cv::Point centre(static_cast<int>(chosen.position.x), static_cast<int>(chosen.position.y));
    Patch blob = fit_blob(levels_, centre, BlobShape(chosen).reach());
    blob.cost = chosen.cost;
    blob.gain = chosen.gain;
    return blob;
  }

  [[nodiscard]] AttributeGraph assemble() const {
    std::map<std::uint32_t, std::uint32_t> number;  // index in the proposals → new id
    for (const Item& item : accepted_)
      if (!item.blob)
        for (const auto v : curves_[item.curve]) number.emplace(v, 0);
    std::vector<Vertex> vertices;
    for (auto& [old, id] : number) {
      id = static_cast<std::uint32_t>(vertices.size());
      vertices.push_back({{id}, {}, proposals_.patch(old)});
    }
    std::vector<graph::Edge> edges;
    for (const Item& item : accepted_) {
      if (item.blob) {
        vertices.push_back({{static_cast<std::uint32_t>(vertices.size())}, {}, *item.blob});
        continue;
      }
      const Curve& curve = curves_[item.curve];
      for (std::size_t i = 1; i < curve.size(); ++i) {
        const auto a = number.at(curve[i - 1]), b = number.at(curve[i]);
        edges.push_back({{std::min(a, b)}, {std::max(a, b)}});
      }
    }
    return name_patch_types(std::move(vertices), std::move(edges));
  }

  const AttributeGraph& proposals_;
  const cv::Mat& levels_;
  cv::Mat1f luma_;
  PursuitOptions pursuit_;
  std::vector<Curve> curves_;
  std::vector<Item> waiting_, accepted_;  // waiting_: the curves, in order; those taken are empty
  std::deque<Item> blobs_;                // of this round
  cv::Mat1f shown_;
  cv::Mat1b mask_, fresh_;  // shown; of them in this round
  cv::Mat1f error_;         // squared, of the fill
  double taken_ = 0;        // pixels
};

}  // namespace

AttributeGraph pursue(const AttributeGraph& proposals, const cv::Mat& levels, const PursuitOptions& pursuit) {
  return Pursuer(proposals, levels, pursuit).run();
}

}  // namespace emberfold::sketch
