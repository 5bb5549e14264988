// SPDX-License-Identifier: BSD-3-Clause
// Pictures to an MP4 file.
#include <headway/core/output_file.h>
#include <headway/core/worker_thread.h>
#include <headway/render/video_file.h>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libswscale/swscale.h>
}

#include <array>
#include <cmath>
#include <future>

namespace headway::render {
namespace {

struct Encoding {
  const char* encoder;
  std::array<std::array<const char*, 2>, 2> options;
};

/// In order of preference, with quality settings for thin lines and small text.
constexpr std::array<Encoding, 3> kEncodings{{
    {"libx264", {{{"preset", "superfast"}, {"crf", "22"}}}},
    {"libopenh264", {{{"allow_skip_frames", "0"}, {"rc_mode", "quality"}}}},
    {"mpeg4", {{{"qmin", "2"}, {"qmax", "5"}}}},
}};

constexpr int kRateUnit = 1000;  ///< denominator of frame rates

struct Free {
  void operator()(AVFormatContext* file) const {
    if (file->pb != nullptr) avio_closep(&file->pb);
    avformat_free_context(file);
  }
  void operator()(AVCodecContext* codec) const { avcodec_free_context(&codec); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  void operator()(SwsContext* conversion) const { sws_freeContext(conversion); }
};

template <typename T>
using Owned = std::unique_ptr<T, Free>;

/// Opens an encoder; null if it does not exist or does not support the size.
Owned<AVCodecContext> openEncoder(const Encoding& encoding, const AVOutputFormat& format,
                                  double rate, cv::Size size) {
  const AVCodec* encoder = avcodec_find_encoder_by_name(encoding.encoder);
  if (encoder == nullptr) return nullptr;
  Owned<AVCodecContext> codec(avcodec_alloc_context3(encoder));
  codec->width = size.width;
  codec->height = size.height;
  codec->pix_fmt = AV_PIX_FMT_YUV420P;
  codec->framerate = {static_cast<int>(std::lround(rate * kRateUnit)), kRateUnit};
  codec->time_base = av_inv_q(codec->framerate);
  codec->gop_size = static_cast<int>(std::ceil(2.0 * rate));  // keyframes for seeking
  codec->bit_rate = static_cast<std::int64_t>(0.2 * rate * size.area());
  codec->color_range = AVCOL_RANGE_MPEG;
  codec->colorspace = AVCOL_SPC_SMPTE170M;
  codec->color_primaries = AVCOL_PRI_SMPTE170M;
  codec->color_trc = AVCOL_TRC_SMPTE170M;
  if ((format.flags & AVFMT_GLOBALHEADER) != 0) codec->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  AVDictionary* options = nullptr;
  for (const auto& [name, value] : encoding.options) av_dict_set(&options, name, value, 0);
  const int failed = avcodec_open2(codec.get(), encoder, &options);
  av_dict_free(&options);
  return failed < 0 ? nullptr : std::move(codec);
}

Owned<AVFrame> newFrame(cv::Size size) {
  Owned<AVFrame> frame(av_frame_alloc());
  frame->format = AV_PIX_FMT_YUV420P;
  frame->width = size.width;
  frame->height = size.height;
  if (av_frame_get_buffer(frame.get(), 0) < 0) throw std::bad_alloc();
  return frame;
}

Owned<SwsContext> newConversion(cv::Size size) {
  Owned<SwsContext> conversion(sws_getContext(size.width, size.height, AV_PIX_FMT_BGR24, size.width,
                                              size.height, AV_PIX_FMT_YUV420P, SWS_BILINEAR,
                                              nullptr, nullptr, nullptr));
  const int* bt601 = sws_getCoefficients(SWS_CS_ITU601);
  constexpr int kOne = 1 << 16;
  sws_setColorspaceDetails(conversion.get(), bt601, /*full range*/ 1, bt601, /*video range*/ 0, 0,
                           kOne, kOne);
  return conversion;
}

}  // namespace

class VideoFile::Encoder {
 public:
  Encoder(const std::string& path, double rate, cv::Size size)
      : path_(path), size_(size), output_(path) {
    CV_Assert(rate > 0.0 && size.width > 0 && size.height > 0);
    CV_Assert(size.width % 2 == 0 && size.height % 2 == 0);
    av_log_set_level(AV_LOG_FATAL);  // errors are returned as values
    AVFormatContext* file = nullptr;
    require(avformat_alloc_output_context2(&file, nullptr, "mp4", output_.temporaryPath().c_str()));
    file_.reset(file);
    for (const auto& encoding : kEncodings) {
      codec_ = openEncoder(encoding, *file_->oformat, rate, size);
      if (codec_ != nullptr) break;
    }
    if (codec_ == nullptr) {
      throw EncoderUnavailable(path_ + ": FFmpeg has no encoder for H.264 or MPEG-4");
    }
    stream_ = avformat_new_stream(file_.get(), nullptr);
    stream_->time_base = codec_->time_base;
    stream_->avg_frame_rate = codec_->framerate;
    require(avcodec_parameters_from_context(stream_->codecpar, codec_.get()));
    require(avio_open(&file_->pb, output_.temporaryPath().c_str(), AVIO_FLAG_WRITE));
    AVDictionary* options = nullptr;
    av_dict_set(&options, "movflags", "faststart", 0);  // index at the start, for streaming
    const int failed = avformat_write_header(file_.get(), &options);
    av_dict_free(&options);
    require(failed);
    frame_ = newFrame(size);
    packet_.reset(av_packet_alloc());
    conversion_ = newConversion(size);
  }

  void add(const cv::Mat& picture) {
    CV_Assert(picture.size() == size_ && picture.type() == CV_8UC3);
    waitForEncoding();
    require(av_frame_make_writable(frame_.get()));
    const std::array<const std::uint8_t*, 1> rows{picture.data};
    const std::array<int, 1> stride{static_cast<int>(picture.step)};
    sws_scale(conversion_.get(), rows.data(), stride.data(), 0, size_.height, frame_->data,
              frame_->linesize);
    frame_->pts = count_++;
    encoding_ = encoder_.run([this] {
      require(avcodec_send_frame(codec_.get(), frame_.get()));
      writePackets();
    });
  }

  void finish() {
    waitForEncoding();
    require(avcodec_send_frame(codec_.get(), nullptr));
    writePackets();
    require(av_write_trailer(file_.get()));
    require(avio_closep(&file_->pb));
    output_.commit();
  }

 private:
  void writePackets() {
    while (true) {
      const int state = avcodec_receive_packet(codec_.get(), packet_.get());
      if (state == AVERROR(EAGAIN) || state == AVERROR_EOF) return;
      require(state);
      packet_->stream_index = stream_->index;
      packet_->duration = 1;
      av_packet_rescale_ts(packet_.get(), codec_->time_base, stream_->time_base);
      require(av_interleaved_write_frame(file_.get(), packet_.get()));
      require(file_->pb->error);  // errors of buffered writes
    }
  }

  /// @throws InputError on an error of the last picture
  void waitForEncoding() {
    if (encoding_.valid()) encoding_.get();
  }

  void require(int result) const {
    if (result >= 0) return;
    std::array<char, AV_ERROR_MAX_STRING_SIZE> reason{};
    av_strerror(result, reason.data(), reason.size());
    throw InputError(path_ + ": the video cannot be written: " + reason.data());
  }

  std::string path_;
  cv::Size size_;
  OutputFile output_;
  Owned<AVFormatContext> file_;
  Owned<AVCodecContext> codec_;
  AVStream* stream_ = nullptr;  ///< of file_
  Owned<AVFrame> frame_;
  Owned<AVPacket> packet_;
  Owned<SwsContext> conversion_;
  std::int64_t count_ = 0;
  std::future<void> encoding_;  ///< of frame_
  WorkerThread encoder_;        ///< the last member, whose destructor waits for the encoding
};

VideoFile::VideoFile(const std::string& path, double rate, cv::Size size)
    : encoder_(std::make_unique<Encoder>(path, rate, size)) {}
VideoFile::~VideoFile() = default;
VideoFile::VideoFile(VideoFile&&) noexcept = default;
VideoFile& VideoFile::operator=(VideoFile&&) noexcept = default;

void VideoFile::add(const cv::Mat& picture) { encoder_->add(picture); }

void VideoFile::finish() { encoder_->finish(); }

}  // namespace headway::render
