#include "io/bag/protobuf_fields.hpp"

#include "io/files/errors.hpp"

namespace motorcade {

std::span<const std::uint8_t> ProtobufFields::take(std::uint64_t size) {
  if (size > rest_.size()) throw InputError(name_ + ": the message ends within a field");
  const auto taken = rest_.first(static_cast<std::size_t>(size));
  rest_ = rest_.subspan(taken.size());
  return taken;
}

std::uint64_t ProtobufFields::fixed(std::size_t size) {
  const auto bytes = take(size);
  std::uint64_t value = 0;
  for (std::size_t i = size; i-- > 0;) value = value << 8 | bytes[i];
  return value;
}

/// Reads seven bits per byte, the lowest first. The eighth says that more follow.
std::uint64_t ProtobufFields::varint() {
  constexpr unsigned kMost_bits = 64;
  std::uint64_t value = 0;
  for (unsigned shift = 0; shift < kMost_bits; shift += 7) {
    const std::uint8_t byte = take(1)[0];
    value |= std::uint64_t{byte & 0x7FU} << shift;
    if (byte < 0x80) return value;
  }
  throw InputError(name_ + ": is no Protobuf message, a number in it has no end");
}

std::optional<ProtobufFields::Field> ProtobufFields::next() {
  if (rest_.empty()) return std::nullopt;
  const std::uint64_t tag = varint();
  Field field{.number = tag >> 3};
  switch (tag & 7) {
    case 0:
      field.value = varint();
      break;
    case 1:
      field.value = fixed(8);
      break;
    case 2:
      field.bytes = take(varint());
      break;
    case 5:
      field.value = fixed(4);
      break;
    default:
      throw InputError(name_ + ": is no Protobuf message");
  }
  return field;
}

}  // namespace motorcade
