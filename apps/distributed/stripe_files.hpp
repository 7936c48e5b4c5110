// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "dytex/distributed/stripe_keeper.hpp"

namespace emberfold::apps {

/// Keeps stripes as files in a folder that all ranks share: stripe-N with a stripe's values, mapped into
/// memory, and one file for each named value.
class StripeFiles final : public dytex::StripeKeeper {
 public:
  explicit StripeFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}
  ~StripeFiles() override;
  StripeFiles(const StripeFiles&) = delete;
  StripeFiles& operator=(const StripeFiles&) = delete;

  void put(std::size_t stripe, std::size_t offset, std::span<const std::byte> values) override;
  std::span<const std::byte> values(std::size_t stripe, std::size_t size) override;
  void flush() override;
  void save(const std::string& name, std::span<const std::byte> bytes) override;
  [[nodiscard]] std::optional<std::vector<std::byte>> load(const std::string& name) override;
  void remove(const std::string& name) override;

 private:
  struct Open {
    int file = -1;
    void* map = nullptr;
    std::size_t size = 0;  // of the map
  };
  Open& opened(std::size_t stripe);
  [[nodiscard]] std::filesystem::path path_of(std::size_t stripe) const;

  std::filesystem::path folder_;
  std::map<std::size_t, Open> open_;
};

/// Begins or resumes the work stored in a folder.
/// The folder is created where missing, and emptied where it holds work with another key. Throws
/// core::IoError where it holds anything else, or cannot be created. Returns whether there is work with this
/// key.
bool begin_kept_work(const std::filesystem::path& folder, const std::string& key);
/// Removes such a folder if it holds nothing that a later run could resume.
void drop_unbegun_work(const std::filesystem::path& folder);

}  // namespace emberfold::apps
