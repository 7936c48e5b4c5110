// SPDX-License-Identifier: Apache-2.0
#include "apps/quilting/checkpoint.hpp"

#include <fstream>
#include <sstream>
#include <utility>

#include <nlohmann/json.hpp>

#include "apps/quilting/fingerprint.hpp"
#include "core/error.hpp"
#include "core/io/files.hpp"

namespace emberfold::apps {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr const char* kFormat = "emberfold.quilt_part";

// Hashes a sample of a clip's bytes, spread over all of it.
std::uint64_t fingerprint(const dytex::Trajectories& source) {
  Fingerprint print;
  const std::size_t bytes = source.course() * source.pixels() * CV_ELEM_SIZE1(source.info().depth);
  for (int c = 0; c < source.chunks(); ++c)
    for (std::size_t i = 0; i < bytes; i += 1 + bytes / 4096)
      print.add(static_cast<std::uint64_t>(source.chunk(c)[i]));
  return print.sum;
}

}  // namespace

QuiltCheckpoint::QuiltCheckpoint(fs::path file, const QuiltRequest& request,
                                 std::span<const dytex::Trajectories* const> held, const std::string& surface)
    : file_(std::move(file)) {
  Json belongs = request_json(request)["quilt"];
  belongs["seed"] = request.quilt.seed;
  if (!surface.empty()) belongs["fingerprint"] = surface;
  for (const auto* one : held)
    belongs["sources"].push_back(
        {one->info().width, one->info().height, one->frames(), std::to_string(fingerprint(*one))});
  belongs_ = belongs.dump();
}

std::vector<dytex::QuiltChoice> QuiltCheckpoint::read() const {
  std::error_code error;
  if (!fs::exists(file_, error)) return {};
  auto stream = io::open_file(file_);
  const Json whole = Json::parse(stream, nullptr, false);
  const auto damaged = [&] {
    throw core::IoError(file_.string() + ": this is no quilt that was begun, or it is damaged");
  };
  if (!whole.is_object() || whole.value("format", "") != kFormat || whole.value("version", 0) != 1) damaged();
  std::vector<dytex::QuiltChoice> placed;
  try {
    if (whole.at("of").dump() != belongs_)
      throw core::InputError(file_.string() +
                             " was begun with other options or another clip; without --resume "
                             "the quilt begins anew");
    for (const auto& b : whole.at("blocks"))
      placed.push_back({b.at(0), b.at(1), {b.at(2), b.at(3), b.at(4)}, b.at(5), b.at(6), b.at(7), false});
  } catch (const Json::exception&) {
    damaged();
  }
  return placed;
}

void QuiltCheckpoint::write(std::span<const dytex::QuiltChoice> placed, bool now) {
  constexpr auto kPause = std::chrono::seconds(5);
  if (!now && std::chrono::steady_clock::now() - written_ < kPause) return;
  Json blocks = Json::array();
  for (const auto& b : placed)
    blocks.push_back({b.column, b.row, b.at.source, b.at.x, b.at.y, b.error, b.equals, b.compared});
  const Json whole = {
      {"format", kFormat}, {"version", 1}, {"of", Json::parse(belongs_)}, {"blocks", std::move(blocks)}};
  const fs::path part = file_.string() + ".new";
  std::ofstream out(part, std::ios::binary | std::ios::trunc);
  out << whole.dump() << "\n";
  out.close();
  std::error_code error;
  if (out) fs::rename(part, file_, error);
  if (!out || error) throw core::IoError("cannot write " + file_.string());
  written_ = std::chrono::steady_clock::now();
}

}  // namespace emberfold::apps
