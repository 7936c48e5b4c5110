// SPDX-License-Identifier: Apache-2.0
#include "core/npy.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <istream>
#include <limits>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <string_view>

#include "core/error.hpp"
#include "core/npy_header.hpp"

namespace emberfold::core {

namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr std::size_t kAlignment = 64;
constexpr std::size_t kMaxHeader = 65535;   // bytes: the limit of version 1, enough for plain arrays
constexpr std::size_t kMaxDimensions = 32;  // of NumPy 1
constexpr std::size_t kGrowthDigits = 21;   // NumPy leaves the growing axis room for this number of digits
constexpr std::size_t kChunk = 1 << 20;     // bytes taken at a time from a stream whose length is unknown
constexpr std::size_t kMaxQuoted = 60;      // characters of a file that a message repeats

[[noreturn]] void fail(const std::string& what) {
  throw IoError("npy: " + what);
}

/// Quotes text of a file for a message: shortened, on one line, in ASCII.
std::string quoted(std::string_view text) {
  std::string result = "'";
  for (const char c : text.substr(0, kMaxQuoted)) result += (c >= ' ' && c <= '~') ? c : '?';
  return result + (text.size() > kMaxQuoted ? "...'" : "'");
}

struct Header {
  std::string type;  ///< kind and size: "f4"
  bool swapped = false;
  bool fortran_order = false;
  std::vector<std::size_t> shape;
};

/// Parses the header, a Python dictionary of a tuple, a boolean and a string.
class HeaderParser {
 public:
  explicit HeaderParser(std::string_view text) : text_(text) {}

  Header parse() {
    expect('{', "the header");
    while (!take('}')) {
      entry();
      if (take(',')) continue;
      expect('}', "the header after an entry");
      break;
    }
    skip_space();
    if (position_ != text_.size()) fail("text after the header's end: " + quoted(rest()));
    for (const auto& [seen, key] :
         {std::pair{descr_, "descr"}, std::pair{order_, "fortran_order"}, std::pair{shape_, "shape"}})
      if (!seen) fail(std::string("the header has no '") + key + "'");
    return header_;
  }

 private:
  void entry() {
    const std::string_view key = string("a key of the header");
    expect(':', "the header after a key");
    if (key == "descr") {
      once(descr_, key);
      descr();
    } else if (key == "fortran_order") {
      once(order_, key);
      header_.fortran_order = boolean();
    } else if (key == "shape") {
      once(shape_, key);
      shape();
    } else {
      fail("the header has an unknown key " + quoted(key));
    }
  }

  static void once(bool& seen, std::string_view key) {
    if (seen) fail("the header has the key " + quoted(key) + " twice");
    seen = true;
  }

  void descr() {
    skip_space();
    const char first = peek();
    if (first != '\'' && first != '"') refuse_type(rest());
    const std::string_view type = string("the dtype");
    if (type.size() != 3) refuse_type(type);
    const char order = type[0];
    const std::string_view code = type.substr(1);
    constexpr std::array<std::string_view, 7> kCodes{"f2", "f4", "f8", "u1", "u2", "i4", "i8"};
    const bool one_byte = code == "u1";
    if (std::find(kCodes.begin(), kCodes.end(), code) == kCodes.end()) refuse_type(type);
    if (order != '<' && order != '>' && !(order == '|' && one_byte)) refuse_type(type);
    header_.type = code;
    header_.swapped = order == (std::endian::native == std::endian::little ? '>' : '<') && !one_byte;
  }

  [[noreturn]] static void refuse_type(std::string_view type) {
    fail("the dtype " + quoted(type) +
         " cannot be read, only f2, f4, f8, u1, u2, i4, i8 after '<' or '>' ('|' for u1)");
  }

  bool boolean() {
    skip_space();
    for (const auto& [word, value] : {std::pair{std::string_view("True"), true}, {"False", false}}) {
      if (!rest().starts_with(word)) continue;
      position_ += word.size();
      return value;
    }
    fail("'fortran_order' must be True or False, not " + quoted(rest()));
  }

  void shape() {
    expect('(', "the shape");
    while (!take(')')) {
      if (header_.shape.size() == kMaxDimensions)
        fail("the shape has more than " + std::to_string(kMaxDimensions) + " dimensions");
      header_.shape.push_back(extent());
      if (take(',')) continue;
      expect(')', "the shape after a number");
      // Without a comma the parentheses hold a number, not a tuple.
      if (header_.shape.size() == 1) fail("the shape must be a tuple");
      break;
    }
  }

  std::size_t extent() {
    skip_space();
    const std::size_t begin = position_;
    if (peek() == '-') fail("the shape has a negative number: " + quoted(rest()));
    std::size_t value = 0;
    while (peek() >= '0' && peek() <= '9') {
      const auto digit = static_cast<std::size_t>(peek() - '0');
      if (value > (std::numeric_limits<std::size_t>::max() - digit) / 10)
        fail("the shape has a number beyond 64 bits: " + quoted(text_.substr(begin)));
      value = 10 * value + digit;
      ++position_;
    }
    if (position_ == begin) fail("the shape must hold whole numbers, not " + quoted(rest()));
    return value;
  }

  std::string_view string(const char* what) {
    skip_space();
    const char quote = peek();
    if (quote != '\'' && quote != '"') fail(std::string(what) + " must be a string, not " + quoted(rest()));
    const std::size_t end = text_.find(quote, position_ + 1);
    if (end == std::string_view::npos) fail(std::string(what) + " has no closing quote: " + quoted(rest()));
    const std::string_view value = text_.substr(position_ + 1, end - position_ - 1);
    position_ = end + 1;
    return value;
  }

  bool take(char c) {
    skip_space();
    if (peek() != c) return false;
    ++position_;
    return true;
  }

  void expect(char c, const char* where) {
    if (!take(c)) fail(std::string(where) + " must have '" + c + "' where it has " + quoted(rest()));
  }

  void skip_space() {
    while (position_ < text_.size() && std::string_view(" \t\r\n\f").find(peek()) != std::string_view::npos)
      ++position_;
  }

  [[nodiscard]] char peek() const { return position_ < text_.size() ? text_[position_] : '\0'; }
  [[nodiscard]] std::string_view rest() const { return text_.substr(position_); }

  std::string_view text_;
  std::size_t position_ = 0;
  Header header_;
  bool descr_ = false, order_ = false, shape_ = false;
};

/// Fills `bytes` or throws IoError, also where the stream itself throws.
void read_bytes(std::istream& in, std::span<char> bytes, const char* what) {
  std::size_t got = 0;
  try {
    in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    got = static_cast<std::size_t>(in.gcount());
  } catch (const std::ios_base::failure&) {
    got = static_cast<std::size_t>(in.gcount());
  }
  if (got == bytes.size() && !in.bad()) return;
  if (in.bad()) fail(std::string("reading failed in ") + what);
  fail(std::string("the stream ends in ") + what + ": " + std::to_string(bytes.size()) + " bytes expected, " +
       std::to_string(got) + " found");
}

/// Returns the number of bytes to the end, if the stream can be sought.
std::optional<std::size_t> remaining_bytes(std::istream& in) {
  std::streambuf& buffer = *in.rdbuf();
  const std::streamoff here = buffer.pubseekoff(0, std::ios::cur, std::ios::in);
  if (here < 0) return std::nullopt;
  const std::streamoff end = buffer.pubseekoff(0, std::ios::end, std::ios::in);
  if (buffer.pubseekpos(here, std::ios::in) != std::streampos(here)) fail("seeking in the stream failed");
  if (end < here) return std::nullopt;
  return static_cast<std::size_t>(end - here);
}

/// Returns the product of the extents.
/// Empty if it exceeds size_t; in an array without elements, if the product of the other extents does.
std::optional<std::size_t> element_count(std::span<const std::size_t> shape) {
  std::size_t product = 1;
  bool none = false;
  for (const std::size_t extent : shape) {
    if (extent == 0) {
      none = true;
    } else if (product > std::numeric_limits<std::size_t>::max() / extent) {
      return std::nullopt;
    } else {
      product *= extent;
    }
  }
  return none ? 0 : product;
}

std::string shape_text(std::span<const std::size_t> shape) {
  std::string text = "(";
  for (std::size_t i = 0; i < shape.size(); ++i) text += (i > 0 ? ", " : "") + std::to_string(shape[i]);
  return text + (shape.size() == 1 ? ",)" : ")");
}

NpyArray::Data empty_data(std::string_view type) {
  if (type == "f2") return std::vector<Half>();
  if (type == "f4") return std::vector<float>();
  if (type == "f8") return std::vector<double>();
  if (type == "u1") return std::vector<std::uint8_t>();
  if (type == "u2") return std::vector<std::uint16_t>();
  if (type == "i4") return std::vector<std::int32_t>();
  return std::vector<std::int64_t>();
}

struct TypeCode {
  std::string_view operator()(std::span<const Half>) const { return "<f2"; }
  std::string_view operator()(std::span<const float>) const { return "<f4"; }
  std::string_view operator()(std::span<const double>) const { return "<f8"; }
  std::string_view operator()(std::span<const std::uint8_t>) const { return "|u1"; }
  std::string_view operator()(std::span<const std::uint16_t>) const { return "<u2"; }
  std::string_view operator()(std::span<const std::int32_t>) const { return "<i4"; }
  std::string_view operator()(std::span<const std::int64_t>) const { return "<i8"; }
};

template <typename T>
void reverse_bytes(std::span<T> values) {
  for (T& value : values) {
    auto bytes = std::bit_cast<std::array<std::byte, sizeof(T)>>(value);
    std::reverse(bytes.begin(), bytes.end());
    value = std::bit_cast<T>(bytes);
  }
}

template <typename T>
void read_values(std::istream& in, const Header& header, std::size_t size_limit, std::vector<T>& values) {
  const std::optional<std::size_t> count = element_count(header.shape);
  if (!count) fail("the shape " + shape_text(header.shape) + " has more elements than 64 bits can count");
  if (*count > size_limit / sizeof(T))
    fail("the shape " + shape_text(header.shape) + " of " + header.type + " is above the limit of " +
         std::to_string(size_limit) + " bytes");
  const std::optional<std::size_t> remaining = remaining_bytes(in);
  if (remaining && *remaining < *count * sizeof(T))
    fail("the stream ends in the data: " + std::to_string(*count * sizeof(T)) + " bytes expected, " +
         std::to_string(*remaining) + " found");
  const std::size_t step = remaining ? std::max<std::size_t>(*count, 1) : kChunk / sizeof(T);
  for (std::size_t have = 0; have < *count;) {
    const std::size_t next = std::min(step, *count - have);
    values.resize(have + next);
    read_bytes(in, {reinterpret_cast<char*>(values.data() + have), next * sizeof(T)}, "the data");
    have += next;
  }
  if (header.swapped) reverse_bytes(std::span<T>(values));
}

Header read_header(std::istream& in) {
  std::array<char, 8> start{};
  read_bytes(in, start, "the first 8 bytes");
  if (std::string_view(start.data(), kMagic.size()) != kMagic)
    fail("no .npy file: it begins with " + quoted({start.data(), kMagic.size()}) + ", not with '\\x93NUMPY'");
  const int major = static_cast<unsigned char>(start[6]), minor = static_cast<unsigned char>(start[7]);
  if (major < 1 || major > 3 || minor != 0)
    fail("format version " + std::to_string(major) + "." + std::to_string(minor) +
         " cannot be read, only 1.0, 2.0 and 3.0");
  std::array<char, 4> length_bytes{};
  read_bytes(in, std::span(length_bytes).first(major == 1 ? 2 : 4), "the header's length");
  std::size_t length = 0;
  for (std::size_t i = 4; i-- > 0;) length = length << 8 | static_cast<unsigned char>(length_bytes[i]);
  if (length > kMaxHeader)
    fail("the header is said to have " + std::to_string(length) + " bytes, at most " +
         std::to_string(kMaxHeader) + " are allowed");
  std::string text(length, '\0');
  read_bytes(in, text, "the header");
  return HeaderParser(text).parse();
}

std::string header_text(const NpyView& array) {
  std::string text = "{'descr': '";
  text += std::visit(TypeCode{}, array.data);
  text += std::string("', 'fortran_order': ") + (array.fortran_order ? "True" : "False");
  text += ", 'shape': " + shape_text(array.shape) + ", }";
  if (!array.shape.empty()) {
    const std::size_t growing = array.fortran_order ? array.shape.back() : array.shape.front();
    text.append(kGrowthDigits - std::to_string(growing).size(), ' ');
  }
  const std::size_t before = kMagic.size() + 4;  // version and length
  const std::size_t total = before + text.size() + 1;
  text.append((kAlignment - total % kAlignment) % kAlignment, ' ');
  return text + '\n';
}

}  // namespace

Half to_half(float value) {
  constexpr std::uint32_t kInfinite = 0x7f800000, kTooLarge = 0x477ff000;  // 65520
  constexpr std::uint32_t kLeastNormal = 0x38800000;                       // 2^-14
  const auto all = std::bit_cast<std::uint32_t>(value);
  const std::uint32_t sign = all >> 16 & 0x8000, size = all & 0x7fffffff;
  if (size > kInfinite) return {static_cast<std::uint16_t>(sign | 0x7e00 | (size >> 13 & 0x3ff))};
  if (size >= kTooLarge) return {static_cast<std::uint16_t>(sign | 0x7c00)};
  if (size < kLeastNormal) {
    // Added to 1/2 the least bit of the sum is worth 2^-24, as that of a small Half: the sum rounds
    // correctly.
    const auto sum = std::bit_cast<std::uint32_t>(std::bit_cast<float>(size) + 0.5F);
    return {static_cast<std::uint16_t>(sign | (sum - std::bit_cast<std::uint32_t>(0.5F)))};
  }
  const std::uint32_t rounded = size + 0xfff + (size >> 13 & 1);
  return {static_cast<std::uint16_t>(sign | ((rounded >> 13) - (112U << 10)))};
}

float to_float(Half half) {
  const std::uint32_t sign = std::uint32_t{half.bits} >> 15 << 31;
  const std::uint32_t exponent = half.bits >> 10 & 0x1f, fraction = half.bits & 0x3ff;
  if (exponent == 0) {
    const float size = static_cast<float>(fraction) * 0x1p-24F;
    return std::bit_cast<float>(sign | std::bit_cast<std::uint32_t>(size));
  }
  const std::uint32_t wide = exponent == 0x1f ? 0xff : exponent + 112;
  return std::bit_cast<float>(sign | wide << 23 | fraction << 13);
}

NpyArray read_npy(std::istream& in, std::size_t size_limit) {
  if (!in) fail("the stream cannot be read");
  Header header = read_header(in);
  NpyArray array{{}, header.fortran_order, empty_data(header.type)};
  std::visit([&](auto& values) { read_values(in, header, size_limit, values); }, array.data);
  array.shape = std::move(header.shape);
  return array;
}

NpyView view(const NpyArray& array) {
  return {array.shape, array.fortran_order,
          std::visit([](const auto& values) -> NpyView::Data { return std::span(values); }, array.data)};
}

std::string npy_header(const NpyView& array) {
  const std::string text = header_text(array);
  const char prefix[] = {1, 0, static_cast<char>(text.size() & 0xff), static_cast<char>(text.size() >> 8)};
  return std::string(kMagic).append(prefix, sizeof prefix) + text;
}

void write_npy(std::ostream& out, const NpyArray& array) {
  write_npy_view(out, view(array));
}

void write_npy_view(std::ostream& out, const NpyView& array) {
  if (array.shape.size() > kMaxDimensions)
    throw InputError("write_npy: the array has " + std::to_string(array.shape.size()) +
                     " dimensions, at most " + std::to_string(kMaxDimensions) + " are allowed");
  const std::size_t size = std::visit([](const auto& values) { return values.size(); }, array.data);
  const std::optional<std::size_t> count = element_count(array.shape);
  if (!count || *count != size)
    throw InputError("write_npy: the shape " + shape_text(array.shape) + " does not fit the data's " +
                     std::to_string(size) + " elements");
  const std::string header = npy_header(array);
  try {
    out << header;
  } catch (const std::ios_base::failure&) {
    throw IoError("npy: writing failed");
  }
  write_npy_values(out, array.data);
}

void write_npy_values(std::ostream& out, const NpyView::Data& data) {
  try {
    std::visit(
        [&]<class T>(std::span<const T> values) {
          const auto write = [&](std::span<const T> part) {
            out.write(reinterpret_cast<const char*>(part.data()),
                      static_cast<std::streamsize>(part.size_bytes()));
          };
          if constexpr (std::endian::native == std::endian::little) return write(values);
          std::vector<T> copy(values.begin(), values.end());
          reverse_bytes(std::span<T>(copy));
          write(copy);
        },
        data);
  } catch (const std::ios_base::failure&) {
    throw IoError("npy: writing failed");
  }
  if (!out) throw IoError("npy: writing failed");
}

}  // namespace emberfold::core
