// SPDX-License-Identifier: Apache-2.0
// Writes videos of a stored kind that OpenCV's writer does not offer: FFV1 in Matroska, by FFmpeg's
// libraries.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <vector>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

namespace emberfold::test {

struct StoredVideo {
  int width = 32, height = 16;
  AVPixelFormat format = AV_PIX_FMT_GRAY8;
  AVColorRange range = AVCOL_RANGE_UNSPECIFIED;
  AVRational aspect = {1, 1};                 ///< of a pixel
  std::vector<std::int64_t> times = {0, 40};  ///< ms, of each frame
};

/// Fills `plane` of each frame by `fill(frame, t)`.
inline void write_stored_video(const std::filesystem::path& path, const StoredVideo& video,
                               const std::function<void(AVFrame&, int)>& fill) {
  const auto check = [](int result) {
    if (result < 0) throw std::runtime_error("the test's video cannot be written");
  };
  AVFormatContext* container = nullptr;
  check(avformat_alloc_output_context2(&container, nullptr, "matroska", path.c_str()));
  const AVCodec* codec = avcodec_find_encoder(AV_CODEC_ID_FFV1);
  AVCodecContext* encoder = avcodec_alloc_context3(codec);
  encoder->width = video.width, encoder->height = video.height;
  encoder->pix_fmt = video.format, encoder->color_range = video.range;
  encoder->sample_aspect_ratio = video.aspect;
  encoder->time_base = {1, 1000};
  check(avcodec_open2(encoder, codec, nullptr));
  AVStream* stream = avformat_new_stream(container, nullptr);
  check(avcodec_parameters_from_context(stream->codecpar, encoder));
  stream->sample_aspect_ratio = video.aspect;
  stream->time_base = {1, 1000};
  check(avio_open(&container->pb, path.c_str(), AVIO_FLAG_WRITE));
  check(avformat_write_header(container, nullptr));
  AVFrame* frame = av_frame_alloc();
  frame->width = video.width, frame->height = video.height, frame->format = video.format;
  frame->color_range = video.range;
  check(av_frame_get_buffer(frame, 0));
  AVPacket* packet = av_packet_alloc();
  for (int t = 0; t <= static_cast<int>(video.times.size()); ++t) {
    const bool last = t == static_cast<int>(video.times.size());
    if (!last) {
      check(av_frame_make_writable(frame));
      fill(*frame, t);
      frame->pts = video.times[static_cast<std::size_t>(t)];
    }
    check(avcodec_send_frame(encoder, last ? nullptr : frame));
    while (avcodec_receive_packet(encoder, packet) >= 0) {
      av_packet_rescale_ts(packet, {1, 1000}, stream->time_base);
      packet->stream_index = stream->index;
      check(av_interleaved_write_frame(container, packet));
    }
  }
  check(av_write_trailer(container));
  av_packet_free(&packet);
  av_frame_free(&frame);
  avcodec_free_context(&encoder);
  avio_closep(&container->pb);
  avformat_free_context(container);
}

/// Sets a value of a plane, of 8 bits or of more.
inline void set_value(AVFrame& frame, int plane, int x, int y, int value, bool deep = false) {
  std::uint8_t* row = frame.data[plane] + static_cast<std::ptrdiff_t>(y) * frame.linesize[plane];
  if (deep)
    reinterpret_cast<std::uint16_t*>(row)[x] = static_cast<std::uint16_t>(value);
  else
    row[x] = static_cast<std::uint8_t>(value);
}

}  // namespace emberfold::test
