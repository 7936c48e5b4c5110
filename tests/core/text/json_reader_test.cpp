// SPDX-License-Identifier: Apache-2.0
#include "core/text/json_reader.hpp"

#include <sstream>
#include <string>

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;

namespace {

std::string parse_refusal(const std::string& text) {
  return test::message_of<core::IoError>([&] { core::parse_json(text); });
}

}  // namespace

TEST_CASE("What is no JSON is refused with the line and the column of its first wrong character") {
  CHECK(parse_refusal("[1, 2") == "no valid JSON at column 5");
  CHECK(parse_refusal("[1, x]") == "no valid JSON at column 5");
  CHECK(parse_refusal("[1,\n  2,\n x]") == "no valid JSON at line 3, column 2");
  CHECK(parse_refusal("\nx") == "no valid JSON at line 2, column 1");
  CHECK(parse_refusal("[1]") == "");
}

TEST_CASE("JSON may be nested 16 deep and no deeper") {
  const auto nested = [](std::size_t deep) { return std::string(deep, '[') + "1" + std::string(deep, ']'); };
  CHECK(parse_refusal(nested(16)) == "");
  CHECK(parse_refusal(nested(17)) == "nested more than 16 deep");
}

TEST_CASE("A quoted text has at most 40 characters, a mark where it had more, and none that is not plain") {
  const std::string forty(40, 'a');
  CHECK(core::quoted(forty) == "\"" + forty + "\"");
  CHECK(core::quoted(forty + "a") == "\"" + forty + "…\"");
  CHECK(core::quoted("a\"b\nc~") == "\"a?b?c~\"");
}

TEST_CASE("Lines are read whole, without their breaks, up to the limit") {
  std::string text(50000, 'x');
  text += "\r\n\nlast";
  std::istringstream in(text);
  const auto first = core::read_line(in, 50001);
  REQUIRE(first);
  CHECK((first->text == std::string(50000, 'x') && first->ended));
  const auto second = core::read_line(in, 10), third = core::read_line(in, 4);
  REQUIRE((second && third));
  CHECK((second->text.empty() && second->ended));
  CHECK((third->text == "last" && !third->ended));
  CHECK(!core::read_line(in, 10));
  std::istringstream again("12345\n");
  CHECK_THROWS_AS(core::read_line(again, 4), core::IoError);
}
