// SPDX-License-Identifier: Apache-2.0
#include "core/npy.hpp"

#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>

#include "core/error.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using core::NpyArray;

using test::contains;

namespace {

std::string file_bytes(const std::string& name) {
  std::ifstream in(std::string(EMBERFOLD_TEST_DATA) + "/npy/" + name + ".npy", std::ios::binary);
  REQUIRE(in);
  std::ostringstream bytes;
  bytes << in.rdbuf();
  return bytes.str();
}

NpyArray read(const std::string& bytes) {
  std::istringstream in(bytes);
  return core::read_npy(in);
}

std::string written(const NpyArray& array) {
  std::ostringstream out;
  core::write_npy(out, array);
  return out.str();
}

/// The message with which reading the bytes is refused; empty where it is not.
std::string refusal(const std::string& bytes) {
  return test::message_of<core::IoError>([&] { read(bytes); });
}

/// A file of format version 1.0 around this dictionary.
std::string with_header(const std::string& dictionary, const std::string& data = std::string(64, '\1')) {
  std::string bytes = "\x93NUMPY\x01";
  bytes += '\0';
  bytes += static_cast<char>(dictionary.size() & 0xff);
  bytes += static_cast<char>(dictionary.size() >> 8);
  return bytes + dictionary + data;
}

/// A stream that tells neither its length nor its place, as a pipe, and hands out a few bytes at a time.
class Pipe final : public std::streambuf {
 public:
  explicit Pipe(std::string bytes) : bytes_(std::move(bytes)) {}

 private:
  int_type underflow() override {
    if (given_ == bytes_.size()) return traits_type::eof();
    const std::size_t count = std::min<std::size_t>(1000, bytes_.size() - given_);
    char* begin = bytes_.data() + given_;
    setg(begin, begin, begin + count);
    given_ += count;
    return traits_type::to_int_type(*begin);
  }
  std::string bytes_;
  std::size_t given_ = 0;
};

constexpr float kInf = std::numeric_limits<float>::infinity();

/// The 2 × 3 tables of make.py, row by row.
const std::vector<std::pair<std::string, NpyArray::Data>>& tables() {
  static const std::vector<std::pair<std::string, NpyArray::Data>> all{
      {"f2", std::vector<core::Half>{{0}, {0xbe00}, {0x4280}, {1}, {0x7bff}, {0xfc00}}},
      {"f4", std::vector<float>{0, -1.5F, 3.25F, std::numeric_limits<float>::denorm_min(),
                                std::numeric_limits<float>::max(), -kInf}},
      {"f8",
       std::vector<double>{0, -1.5, 0.1, std::numeric_limits<double>::denorm_min(),
                           std::numeric_limits<double>::max(), -std::numeric_limits<double>::infinity()}},
      {"u1", std::vector<std::uint8_t>{0, 1, 2, 127, 128, 255}},
      {"u2", std::vector<std::uint16_t>{0, 1, 258, 32768, 65534, 65535}},
      {"i4", std::vector<std::int32_t>{0, -1, 1, 0x01020304, std::numeric_limits<std::int32_t>::min(),
                                       std::numeric_limits<std::int32_t>::max()}},
      {"i8", std::vector<std::int64_t>{0, -1, 1, 0x0102030405060708, std::numeric_limits<std::int64_t>::min(),
                                       std::numeric_limits<std::int64_t>::max()}}};
  return all;
}

/// The table, column by column.
NpyArray::Data columns(const NpyArray::Data& rows) {
  return std::visit(
      [](const auto& v) -> NpyArray::Data {
        return std::decay_t<decltype(v)>{v[0], v[3], v[1], v[4], v[2], v[5]};
      },
      rows);
}

std::vector<std::int32_t> counting(std::int32_t count) {
  std::vector<std::int32_t> values;
  for (std::int32_t i = 0; i < count; ++i) values.push_back(i);
  return values;
}

}  // namespace

TEST_CASE("NumPy's own files read as the values they were made of", "[core][npy]") {
  for (const auto& [type, rows] : tables()) {
    for (const std::string order : {"le", "be"}) {
      if (type == "u1" && order == "be") continue;
      CAPTURE(type, order);
      CHECK(read(file_bytes(type + "_" + order + "_c")) == NpyArray{{2, 3}, false, rows});
      CHECK(read(file_bytes(type + "_" + order + "_f")) == NpyArray{{2, 3}, true, columns(rows)});
    }
  }
  CHECK(read(file_bytes("cube_c")) == NpyArray{{2, 3, 4}, false, counting(24)});
  const NpyArray cube = read(file_bytes("cube_f"));
  CHECK(cube.fortran_order);
  const auto& values = std::get<std::vector<std::int32_t>>(cube.data);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 4; ++k)
        CHECK(values[i + 2 * (j + 3 * k)] == static_cast<std::int32_t>(k + 4 * (j + 3 * i)));
  CHECK(read(file_bytes("zero_d")) == NpyArray{{}, false, std::vector<double>{-2.5}});
  CHECK(read(file_bytes("one_d")) == NpyArray{{5}, false, std::vector<std::uint16_t>{0, 1, 2, 3, 4}});
  CHECK(read(file_bytes("no_elements")) == NpyArray{{3, 0, 2}, false, std::vector<float>{}});
  CHECK(read(file_bytes("version_2")) == NpyArray{{3}, false, counting(3)});
  CHECK(read(file_bytes("version_3")) == NpyArray{{3}, false, counting(3)});
}

TEST_CASE("What is written is byte for byte what NumPy writes", "[core][npy]") {
  for (const auto& [type, rows] : tables()) {
    CAPTURE(type);
    CHECK(written({{2, 3}, false, rows}) == file_bytes(type + "_le_c"));
    CHECK(written({{2, 3}, true, columns(rows)}) == file_bytes(type + "_le_f"));
  }
  CHECK(written({{2, 3, 4}, false, counting(24)}) == file_bytes("cube_c"));
  CHECK(written({{}, false, std::vector<double>{-2.5}}) == file_bytes("zero_d"));
  CHECK(written({{5}, false, std::vector<std::uint16_t>{0, 1, 2, 3, 4}}) == file_bytes("one_d"));
  CHECK(written({{3, 0, 2}, false, std::vector<float>{}}) == file_bytes("no_elements"));
  // Here the room that NumPy leaves for a growing axis decides how long the header gets.
  std::vector<std::size_t> axes(19, 1);
  axes.push_back(2);
  CHECK(written({axes, false, std::vector<double>{1.5, -2.5}}) == file_bytes("many_axes"));
}

TEST_CASE("Arrays of every type, order and shape survive writing and reading", "[core][npy]") {
  const std::vector<std::vector<std::size_t>> shapes{
      {}, {1}, {7}, {0}, {5, 4}, {4, 0}, {2, 1, 3}, {1, 2, 3, 4, 5}, std::vector<std::size_t>(32, 1)};
  for (const auto& [type, rows] : tables())
    for (const auto& shape : shapes)
      for (const bool fortran_order : {false, true}) {
        std::size_t count = 1;
        for (const std::size_t extent : shape) count *= extent;
        NpyArray array{shape, fortran_order, rows};
        std::visit(
            [&](auto& values) {
              const auto six = values;
              values.clear();
              for (std::size_t i = 0; i < count; ++i) values.push_back(six[(i * 5 + 1) % 6]);
            },
            array.data);
        CAPTURE(type, shape, fortran_order);
        const std::string bytes = written(array);
        CHECK(read(bytes) == array);
        const std::size_t header =
            10 + static_cast<unsigned char>(bytes[8]) + 256U * static_cast<unsigned char>(bytes[9]);
        CHECK(header % 64 == 0);
        CHECK(bytes[header - 1] == '\n');
      }
}

TEST_CASE("The bits of a float survive, a NaN's too", "[core][npy]") {
  const auto nan = std::bit_cast<double>(std::uint64_t{0x7ff8dead0000beef});
  const NpyArray back = read(written({{2}, false, std::vector<double>{nan, -0.0}}));
  const auto& values = std::get<std::vector<double>>(back.data);
  CHECK(std::bit_cast<std::uint64_t>(values[0]) == 0x7ff8dead0000beef);
  CHECK(std::bit_cast<std::uint64_t>(values[1]) == 0x8000000000000000);
}

TEST_CASE("Halves and floats turn into each other as in NumPy", "[core][npy]") {
  for (std::uint32_t bits = 0; bits < 65536; ++bits) {
    const core::Half half{static_cast<std::uint16_t>(bits)};
    const int exponent = static_cast<int>(bits >> 10 & 31), fraction = static_cast<int>(bits & 1023);
    const float value = core::to_float(half);
    CAPTURE(bits, value);
    if (exponent == 31 && fraction != 0) {
      if (value == value) FAIL("a NaN became a number");
      if (const float back = core::to_float(core::to_half(value)); back == back) FAIL("and is lost");
      continue;
    }
    const float size = exponent == 31  ? kInf
                       : exponent == 0 ? std::ldexp(static_cast<float>(fraction), -24)
                                       : std::ldexp(static_cast<float>(1024 + fraction), exponent - 25);
    if (value != std::copysign(size, bits < 32768 ? 1.0F : -1.0F)) FAIL("another value");
    if (core::to_half(value) != half) FAIL("not the same half again");
  }
  const auto floats = std::get<std::vector<float>>(read(file_bytes("floats")).data);
  const auto halves = std::get<std::vector<core::Half>>(read(file_bytes("floats_as_f2")).data);
  REQUIRE(floats.size() == halves.size());
  for (std::size_t i = 0; i < floats.size(); ++i) {
    CAPTURE(floats[i]);
    if (core::to_half(floats[i]) != halves[i]) FAIL("rounded to another half");
  }
}

TEST_CASE("A header may be laid out in any way that Python reads", "[core][npy]") {
  const std::string data("\x01\x00\x00\x00\x02\x00\x00\x00", 8);
  const NpyArray expected{{2, 1}, true, std::vector<std::int32_t>{1, 2}};
  for (const char* dictionary : {
           "{'descr': '<i4', 'fortran_order': True, 'shape': (2, 1), }    \n",
           "{'shape':(2,1),'descr':'<i4','fortran_order':True}",
           "{\"fortran_order\" : True ,\n \"shape\" : ( 2 ,\t1 , ) , \"descr\" : \"<i4\" , }",
           "  { 'descr' : '<i4', 'shape' : (\n02, 1), 'fortran_order' : True }\n\n",
       }) {
    CAPTURE(dictionary);
    CHECK(read(with_header(dictionary, data)) == expected);
  }
  for (const char order : {'<', '>', '|'}) {
    const std::string dictionary =
        std::string("{'descr': '") + order + "u1', 'fortran_order': False, 'shape': (2,)}";
    CHECK(read(with_header(dictionary, "\x07\xff")) ==
          NpyArray{{2}, false, std::vector<std::uint8_t>{7, 255}});
  }
}

TEST_CASE("Arrays can follow each other in one stream", "[core][npy]") {
  std::istringstream in(file_bytes("zero_d") + file_bytes("no_elements") + file_bytes("i4_be_f") + "tail");
  CHECK(std::get<std::vector<double>>(core::read_npy(in).data) == std::vector<double>{-2.5});
  CHECK(core::read_npy(in).shape == std::vector<std::size_t>{3, 0, 2});
  CHECK(core::read_npy(in).fortran_order);
  std::string rest;
  in >> rest;
  CHECK(rest == "tail");
}

TEST_CASE("A pipe is read as a file is", "[core][npy]") {
  const NpyArray array{{1000, 1300}, false, counting(1300000)};  // more than two chunks
  const std::string bytes = written(array);
  {
    Pipe pipe(bytes);
    std::istream in(&pipe);
    CHECK(core::read_npy(in) == array);
  }
  // The promise of 32 GiB costs no more memory than what comes.
  Pipe pipe(with_header("{'descr': '<f8', 'fortran_order': False, 'shape': (4294967296,), }"));
  std::istream in(&pipe);
  CHECK_THROWS_AS(core::read_npy(in), core::IoError);
}

TEST_CASE("A file cut at any byte is refused", "[core][npy]") {
  for (const char* name : {"f4_le_c", "i8_be_f", "u1_le_c", "zero_d", "version_2"}) {
    const std::string bytes = file_bytes(name);
    for (std::size_t length = 0; length < bytes.size(); ++length) {
      CAPTURE(name, length);
      CHECK(contains(refusal(bytes.substr(0, length)), "the stream ends in"));
      Pipe pipe(bytes.substr(0, length));
      std::istream in(&pipe);
      CHECK_THROWS_AS(core::read_npy(in), core::IoError);
    }
  }
}

TEST_CASE("What is no array of the seven types is refused with its cause", "[core][npy]") {
  const auto file = [](const std::string& descr, const std::string& order, const std::string& shape) {
    return with_header("{'descr': " + descr + ", 'fortran_order': " + order + ", 'shape': " + shape +
                       ", }\n");
  };
  const auto shape = [&](const std::string& text) { return file("'<f4'", "False", text); };
  const auto type = [&](const std::string& text) { return file(text, "False", "(2,)"); };
  std::string version_9 = file_bytes("one_d"), minor_1 = version_9, wrong_magic = version_9;
  version_9[6] = 9;
  minor_1[7] = 1;
  wrong_magic[0] = 'P';
  std::string long_header = file_bytes("version_2");
  long_header[10] = 1;  // 65536 more
  std::string deep = "(";
  for (int i = 0; i < 33; ++i) deep += "1,";
  const std::vector<std::pair<std::string, std::string>> table{
      {wrong_magic, "no .npy file: it begins with 'PNUMPY'"},
      {"PK\x03\x04 a zip file", "it begins with 'PK?? a'"},
      {version_9, "format version 9.0 cannot be read"},
      {minor_1, "format version 1.1 cannot be read"},
      {long_header, "the header is said to have"},
      {file_bytes("refused_f16"), "the dtype '<f16' cannot be read"},
      {file_bytes("refused_complex"), "the dtype '<c8'"},
      {file_bytes("refused_text"), "the dtype '<U2'"},
      {file_bytes("refused_object"), "the dtype '|O'"},
      {file_bytes("refused_record"), "the dtype '[('x', '<f4')"},
      {type("'=f4'"), "the dtype '=f4'"},
      {type("'|f4'"), "the dtype '|f4'"},
      {type("'f4'"), "the dtype 'f4'"},
      {type("'<u4'"), "the dtype '<u4'"},
      {type("''"), "the dtype ''"},
      {type("4"), "the dtype '4"},
      {type("'<f4"), "the dtype"},
      {shape("(-1,)"), "negative number: '-1"},
      {shape("(2, -3)"), "negative number: '-3"},
      {shape("(18446744073709551616,)"), "a number beyond 64 bits: '18446744073709551616"},
      {shape("(4294967296, 4294967296)"), "(4294967296, 4294967296) has more elements than"},
      {shape("(0, 4294967296, 4294967296)"), "has more elements than"},
      {shape("(18446744073709551615,)"), "above the limit of 68719476736 bytes"},
      {shape("(17179869185,)"), "above the limit of 68719476736 bytes"},
      {shape("(17179869184,)"), "68719476736 bytes expected, 64 found"},
      {shape("(17,)"), "68 bytes expected, 64 found"},
      {shape("2"), "the shape must have '('"},
      {shape("(2)"), "the shape must be a tuple"},
      {shape("[2]"), "the shape must have '('"},
      {shape("(2.0,)"), "the shape after a number must have ')' where it has '.0"},
      {shape("(,)"), "whole numbers, not ',)"},
      {shape("(2,,3)"), "whole numbers, not ',3"},
      {shape("('2',)"), "whole numbers, not ''2'"},
      {shape(deep + ")"), "more than 32 dimensions"},
      {file("'<f4'", "0", "(2,)"), "must be True or False, not '0"},
      {file("'<f4'", "true", "(2,)"), "must be True or False"},
      {with_header("{'fortran_order': False, 'shape': (2,)}"), "the header has no 'descr'"},
      {with_header("{'descr': '<f4', 'shape': (2,)}"), "the header has no 'fortran_order'"},
      {with_header("{'descr': '<f4', 'fortran_order': False}"), "the header has no 'shape'"},
      {with_header("{}"), "the header has no 'descr'"},
      {with_header("{'descr': '<f4', 'descr': '<f4', }"), "the key 'descr' twice"},
      {with_header("{'descr': '<f4', 'title': 'x'}"), "an unknown key 'title'"},
      {with_header("{'descr': '<f4' 'fortran_order': False}"), "the header after an entry must have '}'"},
      {with_header("{'descr' '<f4'}"), "the header after a key must have ':'"},
      {with_header("{descr: '<f4'}"), "a key of the header must be a string"},
      {with_header("{'descr"), "has no closing quote"},
      {with_header(""), "the header must have '{'"},
      {with_header("nonsense"), "the header must have '{' where it has 'nonsense'"},
      {with_header(std::string(60000, '{')), "a key of the header must be a string"},
      {with_header("{'descr': '<f4', 'fortran_order': False, 'shape': ()} x"),
       "text after the header's end: 'x'"}};
  for (const auto& [bytes, cause] : table) {
    const std::string message = refusal(bytes);
    CAPTURE(cause, message);
    CHECK(contains(message, cause));
    CHECK(message.rfind("npy: ", 0) == 0);
    CHECK(message.find('\n') == std::string::npos);
    CHECK(message.size() < 200);
  }
}

TEST_CASE("No flipped byte in a header does more than change or refuse the array", "[core][npy]") {
  const std::string bytes = file_bytes("i4_le_c");
  std::size_t read_well = 0, refused = 0;
  for (std::size_t place = 0; place < 128; ++place)
    for (int value = 0; value < 256; ++value) {
      std::string changed = bytes;
      changed[place] = static_cast<char>(value);
      try {
        const NpyArray array = read(changed);
        std::size_t count = 1;
        for (const std::size_t extent : array.shape) count *= extent;
        CHECK(std::visit([](const auto& values) { return values.size(); }, array.data) == count);
        ++read_well;
      } catch (const core::IoError&) {
        ++refused;
      }
    }
  CHECK(read_well >= 128);  // one value of each place is the file's own
  CHECK(refused > read_well);
}

TEST_CASE("The limit on the size holds before memory is taken", "[core][npy]") {
  std::istringstream in(file_bytes("f8_le_c"));
  try {
    core::read_npy(in, 47);
    FAIL("48 bytes passed a limit of 47");
  } catch (const core::IoError& error) {
    CHECK(contains(error.what(), "the shape (2, 3) of f8 is above the limit of 47 bytes"));
  }
  std::istringstream again(file_bytes("f8_le_c"));
  CHECK(core::read_npy(again, 48).shape.size() == 2);
}

TEST_CASE("A stream that fails is an IoError whether it throws or not", "[core][npy]") {
  std::istringstream failed("");
  failed.setstate(std::ios::badbit);
  CHECK_THROWS_AS(core::read_npy(failed), core::IoError);
  std::istringstream throwing(file_bytes("one_d").substr(0, 50));
  throwing.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
  CHECK_THROWS_AS(core::read_npy(throwing), core::IoError);

  const NpyArray array{{1}, false, std::vector<float>{1}};
  std::ostringstream out;
  out.setstate(std::ios::badbit);
  CHECK_THROWS_AS(core::write_npy(out, array), core::IoError);
  std::ofstream full("/dev/full", std::ios::binary);
  if (full) {
    const NpyArray large{{1 << 20}, false, std::vector<std::uint8_t>(1 << 20)};
    CHECK_THROWS_AS(core::write_npy(full, large), core::IoError);
  }
}

TEST_CASE("An array whose shape and data disagree is not written", "[core][npy]") {
  std::ostringstream out;
  for (const std::vector<std::size_t>& shape : {std::vector<std::size_t>{},
                                                {5},
                                                {7},
                                                {2, 2},
                                                {0},
                                                {std::size_t{1} << 63, 4},
                                                std::vector<std::size_t>(33, 1)})
    CHECK_THROWS_AS(core::write_npy(out, {shape, false, std::vector<float>(6)}), core::InputError);
  CHECK(out.str().empty());
  try {
    core::write_npy(out, {{2, 2}, false, std::vector<float>(6)});
  } catch (const core::InputError& error) {
    CHECK(std::string(error.what()) == "write_npy: the shape (2, 2) does not fit the data's 6 elements");
  }
}
