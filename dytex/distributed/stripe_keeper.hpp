// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace emberfold::dytex {

/// Stores the ranks' results, so that a later run of the same job resumes there, also at another number of
/// ranks. All ranks see what all have stored. Functions throw core::IoError.
class StripeKeeper {
 public:
  StripeKeeper() = default;
  virtual ~StripeKeeper() = default;
  StripeKeeper(const StripeKeeper&) = delete;
  StripeKeeper& operator=(const StripeKeeper&) = delete;

  /// Puts a part of a stripe's values at an offset, bytes. Only its owner does.
  virtual void put(std::size_t stripe, std::size_t offset, std::span<const std::byte> values) = 0;
  /// Returns the first `size` bytes that were put; valid as long as the keeper.
  virtual std::span<const std::byte> values(std::size_t stripe, std::size_t size) = 0;
  /// Returns once all that this rank has put survives a crash of the machine.
  virtual void flush() = 0;

  /// Stores bytes under a name, whole or not at all, in place of what had that name.
  virtual void save(const std::string& name, std::span<const std::byte> bytes) = 0;
  [[nodiscard]] virtual std::optional<std::vector<std::byte>> load(const std::string& name) = 0;
  virtual void remove(const std::string& name) = 0;
};

}  // namespace emberfold::dytex
