// SPDX-License-Identifier: Apache-2.0
// Video by FFmpeg's own libraries: OpenCV's writer passes no option to the encoder, and reports no error.
#include "core/io/writing/video_file.hpp"

#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <system_error>
#include <utility>

extern "C" {
#include <libavutil/opt.h>
#include <libavutil/rational.h>
}

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/io/media_log.hpp"
#include "core/io/media_objects.hpp"
#include "core/io/scratch.hpp"
#include "core/io/writing/fitted_frame.hpp"
#include "core/text/size_text.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

namespace {

/// Returns a rate, frames a second, as a ratio: 29.97 and the like are those of NTSC, 30000/1001.
AVRational rate_ratio(double fps) {
  constexpr double kRounded = 1.5e-6;  // share: of 29.97 to 30000/1001, and a little more
  constexpr int kLargest = 1'001'000;  // of both numbers: errors stay below 1e-6
  const double whole = std::round(fps * 1.001);
  if (fps != std::round(fps) && std::abs(whole / 1.001 - fps) < kRounded * fps)
    return {static_cast<int>(whole) * 1000, 1001};
  return av_d2q(fps, kLargest);
}

/// Names a file in progress. Removes it at the end, unless it has got another name.
class ScratchFile {
 public:
  ScratchFile(const fs::path& folder, const char* extension) : path_(scratch_path(folder, extension)) {}
  ~ScratchFile() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Writes an .mp4 (H.264) or else an .avi (FFV1): the same bytes for the same frames.
class EncodedFile {
 public:
  /// size: even. Throws core::IoError where it cannot be written, as the other calls do.
  EncodedFile(fs::path path, bool mp4, cv::Size size, double fps, bool colour)
      : path_(std::move(path)), part_(path_.parent_path(), mp4 ? ".mp4" : ".avi"), size_(size) {
    AVFormatContext* container = nullptr;
    avformat_alloc_output_context2(&container, nullptr, mp4 ? "mp4" : "avi", part_.path().c_str());
    container_ = owned(container);
    container_->flags |= AVFMT_FLAG_BITEXACT;  // neither date nor version
    const auto given = colour ? AV_PIX_FMT_BGR24 : AV_PIX_FMT_GRAY8;
    const auto stored = mp4 ? AV_PIX_FMT_YUV420P : colour ? AV_PIX_FMT_BGRA : AV_PIX_FMT_GRAY8;
    open_encoder(mp4, stored, rate_ratio(fps));
    given_ = picture(given);
    if (stored != given) {
      stored_ = picture(stored);
      scaler_ = owned(sws_getContext(size.width, size.height, given, size.width, size.height, stored,
                                     SWS_BICUBIC, nullptr, nullptr, nullptr));
    }
    packet_ = owned(av_packet_alloc());
    open_file();
  }

  [[nodiscard]] long long frames() const { return frames_; }

  /// Adds a frame. One that is a column or row smaller than the file has its last one twice.
  void add(const cv::Mat& frame) {
    check(av_frame_make_writable(given_.get()));
    cv::Mat padded(size_, frame.type(), given_->data[0], static_cast<std::size_t>(given_->linesize[0]));
    cv::copyMakeBorder(frame, padded, 0, size_.height - frame.rows, 0, size_.width - frame.cols,
                       cv::BORDER_REPLICATE | cv::BORDER_ISOLATED);
    if (stored_) {
      check(av_frame_make_writable(stored_.get()));
      check(sws_scale(scaler_.get(), given_->data, given_->linesize, 0, size_.height, stored_->data,
                      stored_->linesize));
    }
    AVFrame* const next = stored_ ? stored_.get() : given_.get();
    next->pts = frames_++;
    encode(next);
  }

  /// Completes the file and gives it its name.
  void finish() {
    encode(nullptr);
    check(av_write_trailer(container_.get()));
    check(avio_closep(&container_->pb));
    std::error_code error;
    fs::rename(part_.path(), path_, error);
    if (error) refuse_to_write(path_, error.message());
  }

 private:
  /// Throws what a failure of FFmpeg's libraries means here.
  void check(int result) const {
    if (result >= 0) return;
    if (result == AVERROR(ENOMEM)) throw std::bad_alloc();
    refuse_to_write(path_, result == AVERROR(ENOSPC)
                               ? "no space is left on the disk"
                               : "the file did not come out whole; the disk may be full");
  }

  [[nodiscard]] Owned<AVFrame> picture(AVPixelFormat format) const {
    auto frame = owned(av_frame_alloc());
    frame->format = format;
    frame->width = size_.width, frame->height = size_.height;
    check(av_frame_get_buffer(frame.get(), 0));
    std::memset(frame->buf[0]->data, 0, frame->buf[0]->size);  // swscale reads beyond the end of a row
    return frame;
  }

  void open_encoder(bool mp4, AVPixelFormat format, AVRational rate) {
    const AVCodec* const encoder = avcodec_find_encoder(mp4 ? AV_CODEC_ID_H264 : AV_CODEC_ID_FFV1);
    int opened = AVERROR_ENCODER_NOT_FOUND;
    if (encoder != nullptr) {
      codec_ = owned(avcodec_alloc_context3(encoder));
      codec_->width = size_.width, codec_->height = size_.height;
      codec_->pix_fmt = format;
      codec_->framerate = rate;
      codec_->time_base = av_inv_q(rate);
      codec_->thread_count = 1;  // x264 makes other bytes with another number
      codec_->flags |= AV_CODEC_FLAG_BITEXACT;
      if ((container_->oformat->flags & AVFMT_GLOBALHEADER) != 0)
        codec_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
      if (mp4) set_quality();
      opened = avcodec_open2(codec_.get(), encoder, nullptr);
    }
    if (opened == AVERROR(ENOMEM)) throw std::bad_alloc();
    if (opened < 0)
      refuse_to_write(path_, std::string("FFmpeg offers no ") + (mp4 ? "H.264" : "FFV1") + " encoder for " +
                                 core::size_text(size_) + " pixels at this rate");
  }

  /// Sets options of x264; other encoders of H.264 ignore them. The PSNR is that of its preset medium or
  /// better, at about the same size, in a third of the time. With mbtree, x264 164 makes different bytes of
  /// equal frames where the processor has AVX-512: mbtree_propagate_list takes macroblocks by eights, and so
  /// reads, beyond the last of a frame, what was never written.
  void set_quality() {
    const auto set = [&](const char* name, const char* value) {
      static_cast<void>(av_opt_set(codec_.get(), name, value, AV_OPT_SEARCH_CHILDREN));
    };
    set("preset", "veryfast");
    set("crf", "24");
    set("x264-params", "mbtree=0:qcomp=0.8:aq-mode=0:chroma-qp-offset=-2");
  }

  void open_file() {
    const int opened = avio_open(&container_->pb, part_.path().c_str(), AVIO_FLAG_WRITE);
    if (opened < 0) refuse_to_write(path_, std::generic_category().message(AVUNERROR(opened)));
    AVStream* const stream = avformat_new_stream(container_.get(), nullptr);
    if (stream == nullptr) throw std::bad_alloc();
    check(avcodec_parameters_from_context(stream->codecpar, codec_.get()));
    stream->avg_frame_rate = codec_->framerate;
    stream->time_base = codec_->time_base;
    check(avformat_write_header(container_.get(), nullptr));
  }

  /// Stores what comes of a frame; of null, what the encoder still holds.
  void encode(const AVFrame* frame) {
    check(avcodec_send_frame(codec_.get(), frame));
    while (true) {
      const int got = avcodec_receive_packet(codec_.get(), packet_.get());
      if (got == AVERROR(EAGAIN) || got == AVERROR_EOF) return;
      check(got);
      packet_->duration = 1;
      packet_->stream_index = 0;
      av_packet_rescale_ts(packet_.get(), codec_->time_base, container_->streams[0]->time_base);
      check(av_interleaved_write_frame(container_.get(), packet_.get()));
    }
  }

  fs::path path_;
  ScratchFile part_;
  cv::Size size_;
  Owned<AVFormatContext> container_;
  Owned<AVCodecContext> codec_;
  Owned<AVFrame> given_, stored_;  ///< stored: none where it is as given
  Owned<SwsContext> scaler_;
  Owned<AVPacket> packet_;
  long long frames_ = 0;
};

class VideoFileWriter final : public VideoWriter {
 public:
  VideoFileWriter(fs::path path, bool mp4, cv::Size size, double fps, bool colour)
      : path_(std::move(path)),
        format_{size, colour || mp4, "8 bits; a folder of PNG takes 16 too, one of EXR floats"} {
    if (fs::is_directory(path_)) refuse_to_write(path_, "a folder has this name");
    silence_media_libraries();
    const cv::Size even(size.width + size.width % 2, size.height + size.height % 2);
    file_ = std::make_unique<EncodedFile>(path_, mp4, even, fps, format_.colour);
  }

  void write(const cv::Mat& frame) override {
    if (!file_) throw core::InputError(path_.string() + ": the clip is finished");
    file_->add(fitted_frame(frame, format_, path_));
  }

  void finish() override {
    if (!file_) throw core::InputError(path_.string() + ": the clip is finished");
    const auto file = std::move(file_);  // goes, however this ends
    if (file->frames() == 0) throw core::InputError(path_.string() + ": a clip needs at least one frame");
    file->finish();
  }

 private:
  fs::path path_;
  FrameFormat format_;
  std::unique_ptr<EncodedFile> file_;
};

}  // namespace

std::unique_ptr<VideoWriter> create_video_file(const fs::path& path, bool mp4, cv::Size size, double fps,
                                               bool colour) {
  return std::make_unique<VideoFileWriter>(path, mp4, size, fps, colour);
}

}  // namespace emberfold::io
