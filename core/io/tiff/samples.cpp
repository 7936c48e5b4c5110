// SPDX-License-Identifier: Apache-2.0
#include "core/io/tiff/samples.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include <opencv2/core.hpp>
#include <tiffio.h>

#include "core/error.hpp"

namespace emberfold::io {

namespace {

int depth_of(const TiffPage& page) {
  const auto is_one_of = [&](std::initializer_list<std::uint64_t> sizes) {
    return std::ranges::find(sizes, page.bits) != sizes.end();
  };
  const bool is_whole = page.format == SAMPLEFORMAT_UINT || page.format == SAMPLEFORMAT_VOID;
  if ((page.format == SAMPLEFORMAT_IEEEFP && is_one_of({16, 32, 64})) ||
      (page.format == SAMPLEFORMAT_INT && is_one_of({8, 16, 32})) || (is_whole && page.bits == 32))
    return CV_32F;
  if (is_whole && page.bits <= 16) return page.bits <= 8 ? CV_8U : CV_16U;
  const std::string kind = page.format == SAMPLEFORMAT_IEEEFP ? "floating-point numbers of "
                           : page.format == SAMPLEFORMAT_INT  ? "signed numbers of "
                           : is_whole                         ? "whole numbers of "
                                                              : "complex numbers of ";
  throw core::IoError("its values are " + kind + std::to_string(page.bits) +
                      " bits; read are 1 to 16 and 32 bits without sign, 8, 16 and 32 with one, and floats");
}

/// Notes alpha and samples of unknown meaning, which follow the colours.
void note_extra(const TiffPage& page, std::size_t colours, SampleMeaning& meaning) {
  const auto is_alpha = [](std::uint64_t kind) {
    return kind == EXTRASAMPLE_ASSOCALPHA || kind == EXTRASAMPLE_UNASSALPHA;
  };
  const bool is_listed = !page.extra.empty() || colours < 3 || page.samples != 4;  // a fourth is alpha
  const std::size_t alpha =
      is_listed ? static_cast<std::size_t>(std::ranges::count_if(page.extra, is_alpha)) : 1;
  const std::size_t extra = page.samples > colours ? page.samples - colours : 0;
  if (alpha > 0) meaning.notes.emplace_back(kAlphaDropped);
  if (!meaning.is_colour)
    meaning.channels = static_cast<int>(std::max<std::size_t>(1, page.samples - std::min(alpha, extra)));
  else if (extra > alpha)
    meaning.notes.emplace_back("its first 3 samples a pixel are read as colours; --channel 3 reads the next");
}

}  // namespace

SampleMeaning meaning_of(const TiffPage& page) {
  SampleMeaning meaning;
  meaning.depth = depth_of(page);
  switch (page.photometric) {
    case PHOTOMETRIC_MINISWHITE:
      meaning.is_inverted = true;
      meaning.notes.emplace_back("0 is white by its head; its values are inverted, so that white is bright");
      break;
    case PHOTOMETRIC_MINISBLACK:
      break;
    case PHOTOMETRIC_RGB:
      meaning.is_colour = page.samples >= 3 && !page.sample;
      break;
    case PHOTOMETRIC_PALETTE:
      meaning.notes.emplace_back("its palette is for display and is not applied; the stored values are read");
      break;
    case PHOTOMETRIC_SEPARATED:
    case PHOTOMETRIC_YCBCR:
    case PHOTOMETRIC_CIELAB:
      if (page.samples >= 3 && page.bits == 8) {
        meaning.is_colour = meaning.is_converted = true;
        return meaning;
      }
      [[fallthrough]];
    default:
      if (page.samples > 1)
        throw core::IoError("its colours are of kind " + std::to_string(page.photometric) + " with " +
                            std::to_string(page.bits) +
                            " bits; read are grey, palette and RGB, and CMYK, YCbCr and Lab of 8 bits");
      meaning.notes.push_back("its values are of kind " + std::to_string(page.photometric) +
                              " by its head, and are read as grey");
  }
  if (!page.sample) note_extra(page, meaning.is_colour ? 3 : 1, meaning);
  return meaning;
}

std::vector<int> samples_of(const TiffPage& page, const SampleMeaning& meaning) {
  if (page.sample) return {*page.sample};
  return meaning.is_colour ? std::vector{2, 1, 0} : std::vector{0};
}

void choose_sample(const std::filesystem::path& path, TiffPage& page, std::optional<int> channel,
                   const core::Warn& warn) {
  const SampleMeaning meaning = meaning_of(page);
  const int last = static_cast<int>(page.samples) - 1;
  if (meaning.is_colour && channel.value_or(0) > 2 && *channel <= last) page.sample = channel;
  if (meaning.channels == 1) return;
  const std::string range = "0 to " + std::to_string(meaning.channels - 1);
  if (channel.value_or(0) >= meaning.channels)
    throw core::InputError(path.string() + ": channel " + std::to_string(*channel) +
                           " is out of range: " + range);
  if (!channel && warn)
    warn(path.string() + ": it has " + std::to_string(meaning.channels) +
         " channels, of which the first is read; --channel " + range + " chooses");
  page.sample = channel.value_or(0);
}

double white_of(const TiffPage& page, const SampleMeaning& meaning) {
  if (page.white) return *page.white;
  if (meaning.depth == CV_8U) return 255;
  if (page.format == SAMPLEFORMAT_IEEEFP) return 1;
  if (page.format == SAMPLEFORMAT_INT) return -1;
  return std::ldexp(1., static_cast<int>(page.bits)) - 1;
}

cv::Mat upright_picture(cv::Mat stored, const TiffPage& page, const SampleMeaning& meaning) {
  if (meaning.is_inverted) cv::subtract(cv::Scalar::all(white_of(page, meaning)), stored, stored);
  const std::uint64_t turned = page.orientation;
  if (turned >= ORIENTATION_LEFTTOP && turned <= ORIENTATION_LEFTBOT) cv::transpose(stored.clone(), stored);
  const bool mirrored = turned == ORIENTATION_TOPRIGHT || turned == ORIENTATION_BOTRIGHT ||
                        turned == ORIENTATION_RIGHTTOP || turned == ORIENTATION_RIGHTBOT;
  const bool upside_down = turned == ORIENTATION_BOTRIGHT || turned == ORIENTATION_BOTLEFT ||
                           turned == ORIENTATION_RIGHTBOT || turned == ORIENTATION_LEFTBOT;
  if (mirrored || upside_down)
    cv::flip(stored.clone(), stored, mirrored && upside_down ? -1 : mirrored ? 1 : 0);
  return stored;
}

}  // namespace emberfold::io
