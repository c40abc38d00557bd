#include "io/bag/foxglove_messages.hpp"

#include <algorithm>
#include <bit>
#include <vector>

#include "io/bag/protobuf_fields.hpp"
#include "io/files/errors.hpp"

namespace motorcade {
namespace {

using Field = ProtobufFields::Field;

std::string textOf(const Field& field) { return {field.bytes.begin(), field.bytes.end()}; }
std::uint32_t numberOf(const Field& field) { return static_cast<std::uint32_t>(field.value); }

/// Google's Timestamp: seconds, which have a sign, and nanoseconds.
std::int64_t stampOf(const Field& timestamp, const std::string& name) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000, kMost_s = 4'000'000'000;
  std::int64_t seconds = 0, nanoseconds = 0;
  ProtobufFields fields(timestamp.bytes, name);
  while (const auto field = fields.next()) {
    if (field->number == 1) seconds = static_cast<std::int64_t>(field->value);
    if (field->number == 2) nanoseconds = static_cast<std::int32_t>(field->value);
  }
  if (seconds < -kMost_s || seconds > kMost_s) throw InputError(name + ": its time is no camera's");
  return seconds * kSecond_ns + nanoseconds;
}

/// Adds doubles, which stand in a row or are a field each.
void addDoubles(std::vector<double>& values, const Field& field, const std::string& name) {
  constexpr std::size_t kMost = 64;
  const auto bytes = field.bytes;
  if (bytes.empty()) values.push_back(std::bit_cast<double>(field.value));
  for (std::size_t i = 0; i + sizeof(double) <= bytes.size() && values.size() <= kMost; i += sizeof(double)) {
    std::uint64_t bits = 0;
    for (std::size_t k = sizeof(double); k-- > 0;) bits = bits << 8 | bytes[i + k];
    values.push_back(std::bit_cast<double>(bits));
  }
  if (values.size() > kMost) throw InputError(name + ": has more numbers than a calibration");
}

template <std::size_t N>
void fill(std::array<double, N>& matrix, const std::vector<double>& values, const std::string& name) {
  if (values.empty()) return;  // zeros, as of a camera that is not calibrated
  if (values.size() != N)
    throw InputError(name + ": a matrix has " + std::to_string(values.size()) + " numbers, " + std::to_string(N) +
                     " are needed");
  std::ranges::copy(values, matrix.begin());
}

}  // namespace

std::int64_t stampOfFoxglove(std::span<const std::uint8_t> message, const std::string& name) {
  ProtobufFields fields(message, name);
  while (const auto field = fields.next())
    if (field->number == 1) return stampOf(*field, name);
  return 0;
}

ImageMessage readFoxgloveImage(std::span<const std::uint8_t> message, const std::string& name) {
  ImageMessage image{.stamp_ns = stampOfFoxglove(message, name)};
  ProtobufFields fields(message, name);
  while (const auto field = fields.next()) {
    if (field->number == 2) image.width = numberOf(*field);
    if (field->number == 3) image.height = numberOf(*field);
    if (field->number == 4) image.encoding = textOf(*field);
    if (field->number == 5) image.step = numberOf(*field);
    if (field->number == 6) image.data = field->bytes;
    if (field->number == 7) image.frame_id = textOf(*field);
  }
  return image;
}

CompressedImageMessage readFoxgloveCompressedImage(std::span<const std::uint8_t> message, const std::string& name) {
  CompressedImageMessage image{.stamp_ns = stampOfFoxglove(message, name)};
  ProtobufFields fields(message, name);
  while (const auto field = fields.next()) {
    if (field->number == 2) image.data = field->bytes;
    if (field->number == 3) image.format = textOf(*field);
    if (field->number == 4) image.frame_id = textOf(*field);
  }
  return image;
}

CameraInfoMessage readFoxgloveCalibration(std::span<const std::uint8_t> message, const std::string& name) {
  CameraInfoMessage info{.stamp_ns = stampOfFoxglove(message, name)};
  std::vector<double> K, R, P;
  ProtobufFields fields(message, name);
  while (const auto field = fields.next()) {
    if (field->number == 2) info.width = numberOf(*field);
    if (field->number == 3) info.height = numberOf(*field);
    if (field->number == 4) info.distortion_model = textOf(*field);
    if (field->number == 5) addDoubles(info.D, *field, name);
    if (field->number == 6) addDoubles(K, *field, name);
    if (field->number == 7) addDoubles(R, *field, name);
    if (field->number == 8) addDoubles(P, *field, name);
    if (field->number == 9) info.frame_id = textOf(*field);
  }
  fill(info.K, K, name);
  fill(info.R, R, name);
  fill(info.P, P, name);
  return info;
}

}  // namespace motorcade
