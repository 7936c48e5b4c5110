// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <stop_token>
#include <string_view>

namespace emberfold::core {

/// How a long call ended. A cancelled call returns what it had finished, which is valid.
enum class Status { done, cancelled };

/// What a long call is given from outside: a way to be stopped and a way to tell how far it is.
/// The default one never stops and tells nobody.
class Context {
 public:
  /// Called with the stage's name and the finished share of it, 0…1; from one thread at a time.
  using Progress = std::function<void(std::string_view stage, double fraction)>;

  Context() = default;
  explicit Context(std::stop_token stop, Progress progress = {});

  [[nodiscard]] bool cancelled() const { return stop_.stop_requested(); }
  void report(std::string_view stage, double fraction) const;
  /// Stopped with this one, telling somebody else.
  [[nodiscard]] Context with_progress(Progress progress) const;

 private:
  std::stop_token stop_;
  Progress progress_;
};

}  // namespace emberfold::core
