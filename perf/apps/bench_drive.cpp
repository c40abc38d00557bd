#include "perf/apps/bench_drive.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "apps/run/process_usage.hpp"
#include "io/files/errors.hpp"
#include "io/images/image_file.hpp"
#include "io/images/png_fast_decoder.hpp"
#include "io/inputs/sequence_decoder.hpp"

namespace motorcade::perf {
namespace {

/// Index of the frame, of `count`, that is shown as the drive's frame `index`.
std::size_t shownFrame(std::size_t index, std::size_t count, Looping looping) {
  if (count == 1) return 0;
  if (looping == Looping::kRound) return index % count;
  const std::size_t position = index % (2 * count - 2);
  return position < count ? position : 2 * count - 2 - position;
}

class HeldSource : public FrameSource {
 public:
  explicit HeldSource(const HeldDrive& drive) : drive_(drive) {}
  std::optional<StereoFrame> next() override {
    if (next_ == drive_.size()) return std::nullopt;
    return drive_.frame(next_++);
  }

 private:
  const HeldDrive& drive_;
  std::size_t next_ = 0;
};

class DiskSource : public FrameSource {
 public:
  DiskSource(const Sequence& drive, std::size_t ahead) : decoder_(drive, FrameRange{}, {.ahead = ahead}) {}
  std::optional<StereoFrame> next() override { return decoder_.next(); }

 private:
  SequenceDecoder decoder_;
};

}  // namespace

Sequence looped(const Sequence& sequence, std::size_t frames, Looping looping) {
  const std::size_t count = sequence.frames.size();
  const std::int64_t span_ns = sequence.stamps.back().ns - sequence.stamps.front().ns;
  const std::int64_t period_ns = count > 1 ? span_ns / static_cast<std::int64_t>(count - 1) : 100'000'000;
  Sequence drive = sequence;
  drive.frames.clear();
  drive.stamps.clear();
  for (std::size_t index = 0; index < frames; ++index) {
    drive.frames.push_back(sequence.frames[shownFrame(index, count, looping)]);
    drive.stamps.push_back(index < count ? sequence.stamps[index] : Timestamp{drive.stamps.back().ns + period_ns});
  }
  return drive;
}

HeldDrive::HeldDrive(const Sequence& drive) {
  std::map<std::filesystem::path, std::size_t> index_of;  // of each pair of files in `distinct`
  std::vector<std::size_t> shown;
  Sequence distinct = drive;
  distinct.frames.clear();
  distinct.stamps.clear();
  for (std::size_t index = 0; index < drive.frames.size(); ++index) {
    const auto [found, is_new] = index_of.try_emplace(drive.frames[index].left, distinct.frames.size());
    if (is_new) {
      distinct.frames.push_back(drive.frames[index]);
      distinct.stamps.push_back(drive.stamps[index]);
    }
    shown.push_back(found->second);
  }

  std::vector<StereoFrame> decoded;
  SequenceDecoder decoder(distinct, FrameRange{});
  while (auto frame = decoder.next()) {
    if (frame->rejected()) throw InputError(frame->problem);
    decoded.push_back(std::move(*frame));
  }

  for (std::size_t index = 0; index < shown.size(); ++index) {
    frames_.push_back(decoded[shown[index]]);
    frames_.back().head.frame.value = static_cast<std::int64_t>(index);
    frames_.back().head.stamp = drive.stamps[index];
    frames_.back().decode_ms = 0;
  }
}

std::unique_ptr<FrameSource> playHeld(const HeldDrive& drive) { return std::make_unique<HeldSource>(drive); }

std::unique_ptr<FrameSource> playFromDisk(const Sequence& drive, std::size_t ahead) {
  return std::make_unique<DiskSource>(drive, ahead);
}

double decodingCpu_ms(const Sequence& drive) {
  constexpr std::size_t kMostPairs = 200;
  const ProcessUsage before = processUsage();
  SequenceDecoder decoder(drive, FrameRange{0, kMostPairs});
  int pairs = 0;
  while (decoder.next()) ++pairs;
  return 1e3 * processUsage().since(before).cpu_s / pairs;
}

std::optional<double> unit_ms(const Sequence& drive) {
  constexpr std::size_t kMostPairs = 100;
  const std::size_t pairs = std::min(kMostPairs, drive.frames.size());
  if (pairs == 0 || imageFormat(drive.frames.front().left) != ImageFormat::kPng) return std::nullopt;
  ImagePool pool;
  double cpu_s = 0;  // reading the files is left out
  for (std::size_t i = 0; i < pairs; ++i)
    for (const StereoSide side : {StereoSide::kLeft, StereoSide::kRight}) {
      const auto& file = drive.frames[i].of(side);
      const std::string bytes = readImageBytes(file);
      const ProcessUsage before = processUsage();
      const Image image = decodeAnyPng(bytes, file, pool);
      cpu_s += processUsage().since(before).cpu_s;
    }
  return 1e3 * cpu_s / static_cast<double>(pairs);
}

}  // namespace motorcade::perf
