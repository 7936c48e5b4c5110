// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace emberfold::io {

/// One tag of an XML text: <name key="value">, its prefix ("ome:") removed.
struct XmlTag {
  std::string name;  ///< of a closing tag with its slash in front
  std::map<std::string, std::string> attributes;
  std::string_view text;  ///< after it, up to the next tag
};

/// Reads the tags of an XML text one after another; of text that is not XML whatever looks like tags.
class XmlTags {
 public:
  explicit XmlTags(std::string_view text) : text_(text) {}
  /// Returns the next tag; nothing after the last.
  std::optional<XmlTag> next();

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace emberfold::io
