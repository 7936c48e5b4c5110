// SPDX-License-Identifier: Apache-2.0
#include "core/io/reading/image_series.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <system_error>

#include "core/error.hpp"
#include "core/io/image_files.hpp"
#include "core/io/tiff_pages.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

namespace {

constexpr double kMostStrangers = 0.1;  // share of files that belong to no series

/// The name with a star for each of its numbers.
std::string without_numbers(const std::string& name) {
  std::string kept;
  for (const char c : name) {
    const bool is_digit = c >= '0' && c <= '9';
    if (!is_digit)
      kept += c;
    else if (!kept.ends_with('*'))
      kept += '*';
  }
  return kept;
}

std::string count_text(std::size_t count) {
  return " (" + std::to_string(count) + " files)";
}

}  // namespace

fs::path first_file(const std::string& name) {
  std::error_code error;
  if (fs::is_directory(name, error)) return list_images(name).front();
  return is_pattern(name) && !fs::exists(name, error) ? match_images(name).front() : fs::path(name);
}

void refuse_several_series(const std::vector<fs::path>& files) {
  std::map<std::string, std::size_t> series;
  for (const auto& file : files) ++series[without_numbers(file.filename().string())];
  std::size_t strangers = 0;
  std::erase_if(series, [&](const auto& one) {
    const bool is_stranger = one.second < 2 || one.first.find('*') == std::string::npos;
    if (is_stranger) strangers += one.second;
    return is_stranger;
  });
  if (series.size() < 2 ||
      static_cast<double>(strangers) > kMostStrangers * static_cast<double>(files.size()))
    return;
  const fs::path folder = files.front().parent_path();
  std::string names;
  std::size_t named = 0;
  for (const auto& [pattern, count] : series) {
    if (named == 4) break;
    names += (named++ > 0 ? ", " : "") + pattern + count_text(count);
  }
  if (series.size() > named) names += " and " + std::to_string(series.size() - named) + " more";
  throw core::InputError(folder.string() + " holds " + std::to_string(series.size()) +
                         " series of images: " + names + "; name one of them, for instance '" +
                         (folder / series.begin()->first).string() + "'");
}

std::string repeated_numbers(const std::vector<fs::path>& files) {
  constexpr const char* kDigits = "0123456789";
  std::map<std::string, std::vector<std::string>> series;  // last numbers by the text before and after them
  for (const auto& file : files) {
    const std::string name = file.filename().string();
    const auto end = name.find_last_of(kDigits, name.rfind('.'));
    if (end == std::string::npos) return {};
    const auto before = name.find_last_not_of(kDigits, end);
    const auto begin = before == std::string::npos ? 0 : before + 1;
    series[name.substr(0, begin) + "*" + name.substr(end + 1)].push_back(name.substr(begin, end + 1 - begin));
  }
  const auto& first = *series.begin();
  const bool repeats =
      std::ranges::all_of(series, [&](const auto& one) { return one.second == first.second; });
  if (series.size() < 2 || first.second.size() < 3 || !repeats) return {};
  const fs::path folder = files.front().parent_path();
  return folder.string() + ": the numbers " + first.second.front() + " to " + first.second.back() +
         " occur in " + std::to_string(series.size()) + " series of images, of which the first is " +
         first.first +
         "; they are read one after the other as one clip. If they are channels or places, name '" +
         (folder / first.first).string() + "'";
}

int pages_alike(const fs::path& path) {
  if (!is_tiff(path)) return 1;
  try {
    const auto pages = read_tiff_pages(path);
    return static_cast<int>(std::ranges::count_if(pages, [&](const TiffPage& page) {
      return page.is_picture() && page.width == pages.front().width && page.height == pages.front().height;
    }));
  } catch (const core::IoError&) {
    return 1;  // reading the file says why
  }
}

void refuse_stacks(const std::vector<fs::path>& files) {
  if (files.size() < 2) return;
  for (const auto& file : files)
    if (const int pages = pages_alike(file); pages > 1)
      throw core::InputError(file.string() + " is a stack of " + std::to_string(pages) +
                             " pages, a clip of its own among " + std::to_string(files.size()) +
                             " images; name the file itself, or use 'emberfold runs batch' for all");
}

}  // namespace emberfold::io
