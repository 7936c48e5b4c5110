// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <new>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libswscale/swscale.h>
}

// Objects of FFmpeg's libraries, each with one owner.
namespace emberfold::io {

struct FreeMedia {
  void operator()(AVFormatContext* container) const {
    if (container->iformat != nullptr) return avformat_close_input(&container);
    avio_closep(&container->pb);
    avformat_free_context(container);
  }
  void operator()(AVCodecContext* codec) const { avcodec_free_context(&codec); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  void operator()(SwsContext* scaler) const { sws_freeContext(scaler); }
};
template <class Object>
using Owned = std::unique_ptr<Object, FreeMedia>;

/// Takes what such a library has allocated. Throws std::bad_alloc for null.
template <class Object>
Owned<Object> owned(Object* object) {
  if (object == nullptr) throw std::bad_alloc();
  return Owned<Object>(object);
}

}  // namespace emberfold::io
