// SPDX-License-Identifier: Apache-2.0
// Video by FFmpeg's own libraries: OpenCV's reader hides range, depth, time and shape of the stored frames.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

extern "C" {
#include <libavutil/display.h>
#include <libavutil/pixdesc.h>
}

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/io/files.hpp"
#include "core/io/frame_decoders.hpp"
#include "core/io/media_log.hpp"
#include "core/io/media_objects.hpp"
#include "core/text/format_number.hpp"
#include "core/text/size_text.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

namespace {

constexpr double kGuessedRate = 25;  // frames a second, where the stream has no rate
constexpr double kMaxRate = 1e6;     // frames a second, as --fps

void report(const core::Warn& warn, const std::string& line) {
  if (warn) warn(line);
}

/// Pixel format as stored, and as returned.
struct PixelKind {
  AVPixelFormat stored = AV_PIX_FMT_NONE;
  bool grey = false, deep = false, full_range = false;

  [[nodiscard]] AVPixelFormat converted() const {
    return grey ? (deep ? AV_PIX_FMT_GRAY16 : AV_PIX_FMT_GRAY8) : deep ? AV_PIX_FMT_BGR48 : AV_PIX_FMT_BGR24;
  }
  [[nodiscard]] int type() const { return CV_MAKETYPE(deep ? CV_16U : CV_8U, grey ? 1 : 3); }
  bool operator==(const PixelKind&) const = default;
};

PixelKind pixel_kind(const AVFrame& frame) {
  const auto format = static_cast<AVPixelFormat>(frame.format);
  const AVPixFmtDescriptor* about = av_pix_fmt_desc_get(format);
  if (about == nullptr) return {format};
  const bool coded = (about->flags & (AV_PIX_FMT_FLAG_PAL | AV_PIX_FMT_FLAG_BITSTREAM)) != 0;
  return {format, about->nb_components <= 2 && !coded, about->comp[0].depth > 8,
          frame.color_range == AVCOL_RANGE_JPEG};
}

/// Clockwise turns that the container asks for.
std::optional<cv::RotateFlags> stored_turn(const AVStream& stream) {
#if LIBAVCODEC_VERSION_MAJOR >= 61
  const AVPacketSideData* data = av_packet_side_data_get(
      stream.codecpar->coded_side_data, stream.codecpar->nb_coded_side_data, AV_PKT_DATA_DISPLAYMATRIX);
  const std::uint8_t* matrix = data == nullptr ? nullptr : data->data;
#else
  const std::uint8_t* matrix = av_stream_get_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, nullptr);
#endif
  if (matrix == nullptr) return std::nullopt;
  const double counter_clockwise = av_display_rotation_get(reinterpret_cast<const std::int32_t*>(matrix));
  if (!std::isfinite(counter_clockwise)) return std::nullopt;
  switch ((std::lround(-counter_clockwise) % 360 + 360) % 360) {
    case 90:
      return cv::ROTATE_90_CLOCKWISE;
    case 180:
      return cv::ROTATE_180;
    case 270:
      return cv::ROTATE_90_COUNTERCLOCKWISE;
    default:
      return std::nullopt;
  }
}

double ratio(AVRational value) {
  return value.num > 0 && value.den > 0 ? av_q2d(value) : 0;
}

/// Frames of one stream in display order.
class FrameStream {
 public:
  /// Throws core::IoError.
  explicit FrameStream(const fs::path& path) {
    AVFormatContext* container = nullptr;
    AVDictionary* options = nullptr;
    av_dict_set(&options, "protocol_whitelist", "file", 0);  // a playlist must not open anything else
    // An absolute name has no colon that FFmpeg would take for a protocol.
    const int opened = avformat_open_input(&container, fs::absolute(path).c_str(), nullptr, &options);
    av_dict_free(&options);
    container_.reset(container);
    if (opened < 0 || avformat_find_stream_info(container, nullptr) < 0) refuse(path);
    for (unsigned i = 0; i < container->nb_streams && stream_ == nullptr; ++i)
      if (container->streams[i]->codecpar->codec_type == AVMEDIA_TYPE_VIDEO &&
          (container->streams[i]->disposition & AV_DISPOSITION_ATTACHED_PIC) == 0)
        stream_ = container->streams[i];
    const AVCodec* codec = stream_ == nullptr ? nullptr : avcodec_find_decoder(stream_->codecpar->codec_id);
    if (codec == nullptr) refuse(path);
    codec_.reset(avcodec_alloc_context3(codec));
    if (avcodec_parameters_to_context(codec_.get(), stream_->codecpar) < 0) refuse(path);
    codec_->thread_count = 0;  // one for each processor; the frames are the same
    codec_->pkt_timebase = stream_->time_base;
    if (avcodec_open2(codec_.get(), codec, nullptr) < 0) refuse(path);
    frame_.reset(av_frame_alloc());
    packet_.reset(av_packet_alloc());
  }

  [[nodiscard]] const AVStream& stream() const { return *stream_; }
  [[nodiscard]] const AVFrame& frame() const { return *frame_; }

  /// Moves to the next frame; false after the last. Skips damaged packets.
  bool advance() {
    while (true) {
      const int got = avcodec_receive_frame(codec_.get(), frame_.get());
      if (got == 0) return true;
      if (got == AVERROR_EOF) return false;
      if (got == AVERROR(EAGAIN) && !send()) return false;
    }
  }

  /// Returns the times of the stream's next packets to be shown, s, at most `count`, ascending; nothing where
  /// one has no time.
  std::vector<double> packet_times(std::size_t count) {
    std::vector<double> times;
    for (; times.size() < count && av_read_frame(container_.get(), packet_.get()) >= 0;
         av_packet_unref(packet_.get())) {
      if (packet_->stream_index != stream_->index || packet_->size == 0 ||
          (packet_->flags & AV_PKT_FLAG_DISCARD) != 0)
        continue;
      if (packet_->pts == AV_NOPTS_VALUE) return {};
      times.push_back(static_cast<double>(packet_->pts) * tick());
    }
    std::ranges::sort(times);
    return times;
  }

  /// Returns the times of the next frames, s, at most `count`; nothing where one has none or comes before
  /// its predecessor.
  std::vector<double> frame_times(std::size_t count) {
    std::vector<double> times;
    while (times.size() < count && advance()) {
      const auto& stamp = frame_->best_effort_timestamp;
      if (stamp == AV_NOPTS_VALUE) return {};
      times.push_back(static_cast<double>(stamp) * tick());
    }
    return std::ranges::is_sorted(times) ? times : std::vector<double>();
  }

  /// Returns whether times, s, match the stream's rate, as far as its ticks and a rounded rate allow.
  [[nodiscard]] bool are_even(const std::vector<double>& times) const {
    constexpr double kExact = 1e-3, kOfInterval = 0.01, kOfRate = 1e-4;  // ticks; shares
    const double interval = 1 / rate(), ticks = interval / tick();
    const bool is_rounded = std::abs(ticks - std::round(ticks)) > kExact * ticks || ticks < 1 - kExact;
    const double rounding = is_rounded ? (1 + kExact) * tick() : kOfInterval * interval;
    for (std::size_t i = 0; i < times.size(); ++i) {
      const double expected = static_cast<double>(i) * interval;
      if (std::abs(times[i] - times[0] - expected) > rounding + kOfRate * expected) return false;
    }
    return true;
  }

  /// Returns width to height of a pixel, from the frame or else the container; 0:1 where neither has it.
  [[nodiscard]] AVRational pixel_aspect() const {
    return av_guess_sample_aspect_ratio(container_.get(), stream_, frame_.get());
  }

  [[nodiscard]] double rate() const {
    for (const double one : {ratio(stream_->avg_frame_rate), ratio(stream_->r_frame_rate)})
      if (one > 0 && one <= kMaxRate) return one;
    return 0;
  }

  /// Returns the number of frames that the container claims, less those marked as not shown.
  [[nodiscard]] std::optional<std::int64_t> claimed() const {
    std::int64_t frames = stream_->nb_frames;
    if (frames > 0) {
      for (int i = 0; i < avformat_index_get_entries_count(stream_); ++i)
        if ((avformat_index_get_entry(stream_, i)->flags & AVINDEX_DISCARD_FRAME) != 0) --frames;
    } else if (container_->duration > 0) {
      frames = std::llround(static_cast<double>(container_->duration) / AV_TIME_BASE * rate());
    }
    return frames >= 1 ? std::optional(frames) : std::nullopt;
  }

 private:
  [[nodiscard]] double tick() const { return av_q2d(stream_->time_base); }

  [[noreturn]] static void refuse(const fs::path& path) {
    throw core::IoError("cannot read " + path.string() + ": it is no video that FFmpeg can open");
  }

  /// Sends the decoder the stream's next packet, or its end after the last. Returns false where neither is
  /// accepted.
  bool send() {
    while (!drained_) {
      const int got = av_read_frame(container_.get(), packet_.get());
      if (got < 0) {
        drained_ = true;
        return avcodec_send_packet(codec_.get(), nullptr) >= 0;
      }
      const bool ours = packet_->stream_index == stream_->index;
      const int sent = ours ? avcodec_send_packet(codec_.get(), packet_.get()) : -1;
      av_packet_unref(packet_.get());
      if (sent >= 0) return true;
    }
    return false;
  }

  Owned<AVFormatContext> container_;
  AVStream* stream_ = nullptr;
  Owned<AVCodecContext> codec_;
  Owned<AVFrame> frame_;
  Owned<AVPacket> packet_;
  bool drained_ = false;
};

class VideoFileDecoder final : public FrameDecoder {
 public:
  VideoFileDecoder(const fs::path& path, const ReadOptions& options, const core::Warn& warn)
      : path_(path), warn_(warn) {
    open();
    take_rate();
    claimed_ = stream_->claimed();
    if (!options.fps && info_.fps_is_known) take_times(options.last);
    info_.frames = claimed_;
    first_ = stream_->advance() ? converted() : cv::Mat();
    if (first_.empty())
      throw core::IoError("cannot read " + path_.string() + ": not one frame of it can be decoded");
    info_.width = first_.cols, info_.height = first_.rows;
    info_.channels = first_.channels();
    info_.depth = first_.depth();
    if (info_.depth == CV_16U) info_.white = 65535;
  }

  [[nodiscard]] const core::ClipInfo& info() const override { return info_; }

  cv::Mat next() override {
    cv::Mat frame;
    if (!first_.empty())
      frame = std::exchange(first_, {});
    else if (ended_ || !stream_->advance())
      return end();
    else
      frame = converted();
    ++position_;
    return frame;
  }

  bool skip() override {
    if (!first_.empty())
      first_.release();
    else if (ended_ || !stream_->advance())
      return !end().empty();
    ++position_;
    return true;
  }

  void rewind() override {
    if (position_ == 0 && !ended_) return;
    open();  // a seek to frame 0 does not reach it in every container
    first_.release();
    position_ = 0;
    ended_ = false;
  }

 private:
  void open() {
    stream_.reset();
    stream_.emplace(path_);
    turn_ = stored_turn(stream_->stream());
  }

  void take_rate() {
    info_.fps = stream_->rate();
    info_.fps_is_known = info_.fps > 0;
    if (!info_.fps_is_known) info_.fps = kGuessedRate;
  }

  /// Finds the time of each frame, up to the end of the range, where they are not evenly spaced. Packets show
  /// whether they are; only decoding shows which are frames.
  void take_times(const std::optional<std::int64_t>& last) {
    constexpr std::size_t kReordered = 64;  // packets: frames are stored at most 16 out of order
    constexpr std::size_t kAll = std::size_t{1} << 40;
    const std::size_t count = last ? static_cast<std::size_t>(*last) : kAll;
    if (stream_->are_even(FrameStream(path_).packet_times(count + kReordered))) return;
    auto times = FrameStream(path_).frame_times(count);
    if (times.size() < 2 || stream_->are_even(times)) return;
    if (!last) claimed_ = std::ssize(times);
    double least = times[1] - times[0], most = least;
    for (std::size_t i = 2; i < times.size(); ++i) {
      least = std::min(least, times[i] - times[i - 1]);
      most = std::max(most, times[i] - times[i - 1]);
    }
    report(warn_, path_.string() + ": its frames are not evenly spaced in time (" +
                      core::significant_text(least, 3) + " to " + core::significant_text(most, 3) +
                      " s apart); each has its own time");
    for (const double first = times[0]; double& time : times) time -= first;
    info_.times = std::move(times);
  }

  /// The frame as levels. Throws core::IoError where it has another size or kind than those before it.
  cv::Mat converted() {
    const AVFrame& frame = stream_->frame();
    const cv::Size size(frame.width, frame.height);
    const PixelKind kind = pixel_kind(frame);
    if (scaler_ && size != stored_)
      throw core::IoError(path_.string() + ": frame " + std::to_string(position_) + " is " +
                          core::size_text(size) + " pixels, those before it " + core::size_text(stored_));
    if (scaler_ && kind.type() != kind_.type())
      throw core::IoError(path_.string() + ": frame " + std::to_string(position_) +
                          " has another depth or number of channels than those before it");
    if (!scaler_ || kind != kind_) make_scaler(size, kind);
    std::uint8_t* rows[4] = {padded_.data};
    const int steps[4] = {static_cast<int>(padded_.step)};
    if (sws_scale(scaler_.get(), frame.data, frame.linesize, 0, frame.height, rows, steps) != frame.height)
      throw core::IoError(path_.string() + ": frame " + std::to_string(position_) + " cannot be converted");
    const cv::Mat levels = padded_.colRange(0, frame.width);
    if (!turn_) return levels.clone();
    cv::Mat turned;
    cv::rotate(levels, turned, *turn_);
    return turned;
  }

  void make_scaler(cv::Size size, const PixelKind& kind) {
    if (!scaler_) check_shape();
    stored_ = size, kind_ = kind;
    constexpr int kBlock = 64;  // px: swscale writes whole vectors, beyond the end of a row
    padded_.create(size.height, (size.width / kBlock + 1) * kBlock, kind.type());
    scaler_.reset(sws_getContext(size.width, size.height, kind.stored, size.width, size.height,
                                 kind.converted(), SWS_BICUBIC, nullptr, nullptr, nullptr));
    if (!scaler_)
      throw core::IoError("cannot read " + path_.string() + ": its pixels (" +
                          av_get_pix_fmt_name(kind.stored) + ") are of no known kind");
    // Swscale assumes limited YUV unless its format says full; the frame's own flag decides.
    if (kind.full_range && !kind.grey) {
      const int* matrix = sws_getCoefficients(SWS_CS_DEFAULT);
      sws_setColorspaceDetails(scaler_.get(), matrix, 1, matrix, 1, 0, 1 << 16, 1 << 16);
    }
  }

  /// Warns of pixels that are not square. Frames stay as stored, so that positions in them are those of the
  /// file.
  void check_shape() const {
    constexpr double kSquare = 1e-3;
    const AVRational aspect = stream_->pixel_aspect();
    const double shape = ratio(aspect);
    if (shape == 0 || std::abs(shape - 1) < kSquare) return;
    report(warn_, path_.string() + ": its pixels are " + std::to_string(aspect.num) + ":" +
                      std::to_string(aspect.den) +
                      " wide to high; angles and lengths are measured as if they were square, so scale the "
                      "clip first (ffmpeg -vf scale=iw*sar:ih,setsar=1)");
  }

  cv::Mat end() {
    if (!ended_ && !warned_ && claimed_ && position_ + 1 < *claimed_) {
      report(warn_, path_.string() + ": only " + std::to_string(position_) + " of the " +
                        std::to_string(*claimed_) +
                        " frames that it promises can be read; it may be cut off");
      warned_ = true;
    }
    ended_ = true;
    info_.frames = position_;
    return {};
  }

  fs::path path_;
  core::Warn warn_;
  std::optional<FrameStream> stream_;
  Owned<SwsContext> scaler_;
  cv::Size stored_;  ///< px of the frames in the stream
  cv::Mat padded_;   ///< a converted frame with extra columns
  PixelKind kind_;
  std::optional<cv::RotateFlags> turn_;
  core::ClipInfo info_;
  std::optional<std::int64_t> claimed_;
  cv::Mat first_;  ///< read to learn the size, not handed out yet
  std::int64_t position_ = 0;
  bool ended_ = false, warned_ = false;
};

}  // namespace

std::unique_ptr<FrameDecoder> decode_video(const fs::path& path, const ReadOptions& options,
                                           const core::Warn& warn) {
  refuse_slices(path, options);
  silence_media_libraries();
  open_file(path);
  std::error_code error;
  if (fs::file_size(path, error) == 0 && !error)
    throw core::IoError("cannot read " + path.string() + ": it is empty");
  return std::make_unique<VideoFileDecoder>(path, options, warn);
}

}  // namespace emberfold::io
