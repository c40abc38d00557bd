#include "io/bag/wire_reader.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "io/files/errors.hpp"

namespace motorcade {

WireReader::WireReader(std::span<const std::uint8_t> message, WireFormat format, std::string name)
    : message_(message), format_(format), name_(std::move(name)) {
  if (format_ != WireFormat::kCdr) return;
  constexpr std::size_t kHead = 4;
  constexpr std::uint8_t kPlain2 = 6;  // XCDR2, of which doubles are aligned to four bytes
  const std::uint8_t kind = take(kHead)[1];
  if (message_[0] != 0 || (kind / 2 != 0 && kind / 2 != kPlain2 / 2)) fail("is no plain CDR message");
  big_endian_ = kind % 2 == 0;
  most_alignment_ = kind >= kPlain2 ? 4 : 8;
  origin_ = kHead;
}

void WireReader::fail(const std::string& what) const { throw InputError(name_ + ": " + what); }

std::span<const std::uint8_t> WireReader::take(std::size_t size) {
  if (size > message_.size() - position_) fail("the message ends within a field");
  const auto taken = message_.subspan(position_, size);
  position_ += size;
  return taken;
}

std::uint64_t WireReader::number(std::size_t size) {
  const std::size_t alignment = std::min(size, most_alignment_);
  take((alignment - (position_ - origin_) % alignment) % alignment);
  const auto bytes = take(size);
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i) value = value << 8 | bytes[big_endian_ ? i : size - 1 - i];
  return value;
}

double WireReader::f64() { return std::bit_cast<double>(number(sizeof(double))); }

void WireReader::fill(std::span<double> values) {
  for (double& value : values) value = f64();
}

/// CDR counts and writes the zero at the end.
std::string WireReader::text() {
  const auto characters = bytes();
  std::string text(characters.begin(), characters.end());
  if (format_ == WireFormat::kCdr && text.ends_with('\0')) text.pop_back();
  return text;
}

std::vector<double> WireReader::doubles(std::size_t most) {
  const std::size_t count = u32();
  if (count > most) fail("has " + std::to_string(count) + " numbers in a list, " + std::to_string(most) + " at most");
  std::vector<double> values(count);
  fill(values);
  return values;
}

}  // namespace motorcade
