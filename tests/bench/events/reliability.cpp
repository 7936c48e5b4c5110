// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/events/reliability.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "graph/events/event_score.hpp"
#include "graph/matching/assignment.hpp"

namespace emberfold::figures {

namespace {

/// Birth 0, death 1, union 2, separation 3.
int four(graph::EventType type) {
  using enum graph::EventType;
  if (type == birth || type == death) return type == birth ? 0 : 1;
  return type == merge || type == connect ? 2 : 3;
}

}  // namespace

void Reliability::count(double probability, bool is_true) {
  const auto place = static_cast<std::size_t>(probability * static_cast<double>(kBins));
  Bin& bin = bins_.at(std::min(kBins - 1, place));
  const double happened = is_true ? 1 : 0;
  bin.events += 1, bin.said += probability, bin.true_ones += happened;
  events_ += 1;
  squares_ += (happened - probability) * (happened - probability);
  variance_ += probability * (1 - probability);
}

void Reliability::add(const std::vector<graph::Event>& truth, const std::vector<graph::Event>& found) {
  const graph::ScoreOptions tolerance;
  constexpr double kPair = 1000;  // one pair more is worth any probability
  std::vector<graph::Candidate> candidates;
  for (std::uint32_t i = 0; i < truth.size(); ++i)
    for (std::uint32_t j = 0; j < found.size(); ++j) {
      const double apart = graph::distance(truth[i].position, found[j].position);
      if (four(truth[i].type) != four(found[j].type) || apart > tolerance.radius ||
          std::abs(truth[i].frame - found[j].frame) > tolerance.frames)
        continue;
      candidates.push_back({i, j, kPair + found[j].probability - 0.01 * apart / tolerance.radius});
    }
  std::vector<bool> is_true(found.size());
  const auto pairs = graph::assign(candidates);
  for (const auto& [i, j] : pairs) is_true[j] = true;
  for (std::size_t j = 0; j < found.size(); ++j) count(found[j].probability, is_true[j]);
  for (std::size_t missed = pairs.size(); missed < truth.size(); ++missed) count(0, true);
}

Reliability::Share Reliability::share_of(const Bin& bin) {
  constexpr double kZ = 1.645;
  const double n = bin.events, p = bin.true_ones / n, z2 = kZ * kZ / n;
  const double middle = (p + z2 / 2) / (1 + z2), half = kZ * std::sqrt((p * (1 - p) + z2 / 4) / n) / (1 + z2);
  return {p, std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

void print(const std::string& name, const Reliability& reliability) {
  std::printf("%-10s | %5.0f | %6.4f %6.4f |", name.c_str(), reliability.events(), reliability.brier(),
              reliability.expected_brier());
  for (const auto& bin : reliability.bins()) {
    if (bin.events > 0)
      std::printf(" %3.0f %.2f", bin.events, bin.true_ones / bin.events);
    else
      std::printf("        -");
  }
  std::printf("\n");
  std::fflush(stdout);
}

void draw(const Reliability& reliability, const std::filesystem::path& path) {
  constexpr int kSide = 400, kMargin = 56, kFont = cv::FONT_HERSHEY_SIMPLEX;
  cv::Mat3b picture(kSide + 2 * kMargin, kSide + 2 * kMargin, cv::Vec3b(255, 255, 255));
  const cv::Scalar ink(60, 60, 60), faint(210, 210, 210), dot(60, 76, 220);
  const auto at = [](double said, double share) {
    return cv::Point(kMargin + cvRound(said * kSide), kMargin + kSide - cvRound(share * kSide));
  };
  cv::rectangle(picture, at(0, 0), at(1, 1), ink);
  cv::line(picture, at(0, 0), at(1, 1), faint, 2, cv::LINE_AA);
  for (int k = 0; k <= 10; k += 2) {
    const std::string text = k == 10 ? "1" : k == 0 ? "0" : "." + std::to_string(k);
    cv::line(picture, at(0.1 * k, 0), at(0.1 * k, -0.015), ink);
    cv::line(picture, at(0, 0.1 * k), at(-0.015, 0.1 * k), ink);
    cv::putText(picture, text, at(0.1 * k, 0) + cv::Point(-8, 22), kFont, 0.45, ink, 1, cv::LINE_AA);
    cv::putText(picture, text, at(0, 0.1 * k) + cv::Point(-28, 5), kFont, 0.45, ink, 1, cv::LINE_AA);
  }
  for (const auto& bin : reliability.bins()) {
    if (bin.events == 0) continue;
    const double said = bin.said / bin.events;
    const auto share = Reliability::share_of(bin);
    cv::line(picture, at(said, share.low), at(said, share.high), ink, 1, cv::LINE_AA);
    cv::circle(picture, at(said, share.share), cvRound(3 + 2 * std::log10(bin.events)), dot, cv::FILLED,
               cv::LINE_AA);
    std::array<char, 16> number{};
    std::snprintf(number.data(), number.size(), "%.0f", bin.events);
    const bool right = said > 0.8;
    cv::putText(picture, number.data(), at(said, share.share) + cv::Point(right ? -44 : 12, right ? 16 : -8),
                kFont, 0.4, ink, 1, cv::LINE_AA);
  }
  std::array<char, 80> title{};
  std::snprintf(title.data(), title.size(), "%.0f events, Brier score %.4f", reliability.events(),
                reliability.brier());
  cv::putText(picture, title.data(), {kMargin, kMargin - 18}, kFont, 0.5, ink, 1, cv::LINE_AA);
  cv::putText(picture, "probability said, against share of true events (90 % intervals)",
              {kMargin, kSide + 2 * kMargin - 12}, kFont, 0.38, ink, 1, cv::LINE_AA);
  if (!cv::imwrite(path.string(), picture)) throw std::runtime_error("cannot write " + path.string());
}

}  // namespace emberfold::figures
