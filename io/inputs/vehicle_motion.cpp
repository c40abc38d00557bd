#include "io/inputs/vehicle_motion.hpp"

#include <algorithm>
#include <iomanip>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>

#include "io/files/errors.hpp"
#include "io/files/line_file.hpp"
#include "io/files/text_file.hpp"
#include "io/sequence/timestamps.hpp"
#include "io/truth/ground_truth.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kHeader = "time_s,speed_mps,yaw_rate_radps";
constexpr std::string_view kHeaderWithSigmas = "time_s,speed_mps,yaw_rate_radps,speed_sigma_mps,yaw_rate_sigma_radps";

double deviation(FieldReader& fields, std::string_view what) {
  const double value = fields.number(what);
  if (value < 0) fields.fail(std::string(what) + " is negative; 0 leaves it open");
  return value;
}

VehicleMotionSample sampleOf(const fs::path& file, const TextLine& line, bool with_sigmas) {
  FieldReader fields(file, line, ',');
  VehicleMotionSample sample;
  sample.stamp = readTime(file, {line.number, std::string(fields.word("time_s"))});
  sample.speed_mps = fields.number("speed_mps");
  sample.yaw_rate_radps = fields.number("yaw_rate_radps");
  if (with_sigmas) {
    sample.speed_sigma_mps = deviation(fields, "speed_sigma_mps");
    sample.yaw_rate_sigma_radps = deviation(fields, "yaw_rate_sigma_radps");
  }
  fields.expectEnd();
  return sample;
}

std::vector<VehicleMotionSample> readMotionTable(const fs::path& file, const std::vector<TextLine>& lines) {
  const std::string header = trimmed(lines.front().text);
  if (header != kHeader && header != kHeaderWithSigmas)
    throw InputError(file.string() + ": begins with '" + printable(header) + "'; '" + std::string(kHeaderWithSigmas) +
                     "' is expected, without the last two columns where deviations are not known");
  std::vector<VehicleMotionSample> samples;
  for (auto line = lines.begin() + 1; line != lines.end(); ++line)
    samples.push_back(sampleOf(file, *line, header == kHeaderWithSigmas));
  std::ranges::stable_sort(samples, {}, &VehicleMotionSample::stamp);
  return samples;
}

/// Times of packets on the clock of the images. Both have times of day where times of the images start anew.
std::vector<Timestamp> stampsOfPackets(const fs::path& file, const Sequence& sequence, std::size_t packets) {
  Sequence with = sequence;
  with.truth.oxts = file;
  std::vector<Timestamp> stamps = packetStamps(with, packets);
  if (with.truth.oxts_timestamps.empty() || with.truth.image_timestamps.empty() || sequence.stamps.empty())
    return stamps;
  const std::vector<Timestamp> images = readTimestamps(with.truth.image_timestamps);
  if (images.empty()) return stamps;
  const std::int64_t shift_ns = sequence.stamps.front().ns - images.front().ns;
  for (Timestamp& stamp : stamps) stamp.ns += shift_ns;
  return stamps;
}

std::vector<VehicleMotionSample> readPackets(const fs::path& file, const Sequence& sequence) {
  const std::vector<OxtsPacket> packets = readOxts(file);
  const std::vector<Timestamp> stamps = stampsOfPackets(file, sequence, packets.size());
  std::vector<VehicleMotionSample> samples;
  for (std::size_t i = 0; i < packets.size(); ++i) {
    if (!packets[i].velocity_mps || !packets[i].yaw_rate_radps)
      throw InputError(file.string() + ": packet " + std::to_string(i) +
                       " ends before its velocity and its turn rates; fields 9 (vf) and 23 (wu) of each are needed");
    samples.push_back(
        {.stamp = stamps[i], .speed_mps = packets[i].velocity_mps->x(), .yaw_rate_radps = *packets[i].yaw_rate_radps});
  }
  return samples;
}

std::string seconds(Timestamp stamp) { return std::to_string(static_cast<double>(stamp.ns) * 1e-9) + " s"; }

void requireOverlap(const fs::path& file, const std::vector<VehicleMotionSample>& samples, const Sequence& sequence) {
  if (sequence.stamps.empty()) return;
  if (samples.front().stamp <= sequence.stamps.back() && samples.back().stamp >= sequence.stamps.front()) return;
  throw InputError(file.string() + ": its times, " + seconds(samples.front().stamp) + " to " +
                   seconds(samples.back().stamp) + ", are not those of the images, " +
                   seconds(sequence.stamps.front()) + " to " + seconds(sequence.stamps.back()) +
                   "; both must be of one clock");
}

bool isTable(const fs::path& file, const std::vector<TextLine>& lines) {
  return file.extension() == ".csv" || trimmed(lines.front().text).starts_with("time_s");
}

}  // namespace

std::vector<VehicleMotionSample> readVehicleMotion(const fs::path& file, const Sequence& sequence) {
  std::vector<VehicleMotionSample> samples;
  if (fs::is_directory(file)) {
    samples = readPackets(file, sequence);
  } else {
    const std::vector<TextLine> lines = readLines(file);
    if (lines.empty()) throw InputError(file.string() + ": is empty; samples of the vehicle's motion are expected");
    samples = isTable(file, lines) ? readMotionTable(file, lines) : readPackets(file, sequence);
  }
  if (samples.empty()) throw InputError(file.string() + ": has no sample of the vehicle's motion");
  requireOverlap(file, samples, sequence);
  return samples;
}

void writeVehicleMotion(const std::vector<VehicleMotionSample>& samples, const fs::path& file) {
  std::ostringstream text;
  text << kHeader << '\n' << std::fixed;
  for (const VehicleMotionSample& sample : samples)
    text << std::setprecision(9) << static_cast<double>(sample.stamp.ns) * 1e-9 << std::setprecision(5) << ','
         << sample.speed_mps << ',' << sample.yaw_rate_radps << '\n';
  writeAtOnce(file, text.str());
}

/// All samples may come at once, before the first pair.
VehicleMotionSource::VehicleMotionSource(std::unique_ptr<PairSource> pairs, std::vector<VehicleMotionSample> samples)
    : ForwardingSource(std::move(pairs)),
      samples_(std::move(samples)),
      log_(std::make_shared<VehicleMotionLog>(samples_.size() + 1)) {}

std::optional<StereoFrame> VehicleMotionSource::next() {
  auto frame = ForwardingSource::next();
  if (!frame) return frame;
  for (; next_ < samples_.size() && samples_[next_].stamp <= frame->head.stamp; ++next_) log_->add(samples_[next_]);
  frame->inputs.vehicle_motion = log_;
  frame->inputs.vehicle_samples = next_;
  return frame;
}

}  // namespace motorcade
