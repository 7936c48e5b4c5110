// SPDX-License-Identifier: Apache-2.0
#include "core/io/tiff/xml_tags.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace emberfold::io {

namespace {

constexpr std::string_view kSpace = " \t\r\n";

/// Replaces the entities that XML writers put into attributes; others stay.
std::string plain(std::string_view value) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kEntities{{{"&amp;", "&"},
                                                                                    {"&quot;", "\""},
                                                                                    {"&apos;", "'"},
                                                                                    {"&lt;", "<"},
                                                                                    {"&gt;", ">"},
                                                                                    {"&#181;", "\u00b5"},
                                                                                    {"&#xB5;", "\u00b5"},
                                                                                    {"&#956;", "\u03bc"}}};
  std::string text;
  while (!value.empty()) {
    const auto* const entity =
        std::ranges::find_if(kEntities, [&](const auto& e) { return value.starts_with(e.first); });
    text += entity != kEntities.end() ? entity->second : value.substr(0, 1);
    value.remove_prefix(entity != kEntities.end() ? entity->first.size() : 1);
  }
  return text;
}

std::string without_prefix(std::string_view name) {
  const bool closes = name.starts_with('/');
  if (closes) name.remove_prefix(1);
  if (const auto colon = name.find(':'); colon != std::string_view::npos) name.remove_prefix(colon + 1);
  return (closes ? "/" : "") + std::string(name);
}

void read_attributes(std::string_view inside, XmlTag& tag) {
  while (true) {
    const auto equals = inside.find('=');
    if (equals == std::string_view::npos) return;
    std::string_view key = inside.substr(0, equals);
    key.remove_prefix(std::min(key.find_first_not_of(kSpace), key.size()));
    key = key.substr(0, key.find_first_of(kSpace));
    const auto open = inside.find_first_of("\"'", equals);
    if (open == std::string_view::npos) return;
    const auto close = inside.find(inside[open], open + 1);
    if (close == std::string_view::npos) return;
    tag.attributes.emplace(without_prefix(key), plain(inside.substr(open + 1, close - open - 1)));
    inside.remove_prefix(close + 1);
  }
}

}  // namespace

std::optional<XmlTag> XmlTags::next() {
  while (true) {
    const auto open = text_.find('<', at_);
    if (open == std::string_view::npos) return std::nullopt;
    const bool is_comment = text_.substr(open).starts_with("<!--");
    const auto close = text_.find(is_comment ? "-->" : ">", open);
    if (close == std::string_view::npos) return std::nullopt;
    at_ = close + 1;
    if (is_comment || text_[open + 1] == '?' || text_[open + 1] == '!') continue;
    const std::string_view inside = text_.substr(open + 1, close - open - 1);
    const auto end = std::min(inside.find_first_of(kSpace), inside.size());
    std::string_view name = inside.substr(0, end);
    if (name.size() > 1 && name.ends_with('/')) name.remove_suffix(1);
    XmlTag tag{without_prefix(name), {}, {}};
    read_attributes(inside.substr(end), tag);
    const auto following = std::min(text_.find('<', at_), text_.size());
    tag.text = text_.substr(at_, following - at_);
    return tag;
  }
}

}  // namespace emberfold::io
