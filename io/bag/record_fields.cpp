#include "io/bag/record_fields.hpp"

#include "io/files/errors.hpp"

namespace motorcade::mcap {

std::span<const std::uint8_t> RecordFields::take(std::uint64_t size) {
  if (size > rest_.size()) throw InputError(place_ + ": a field is longer than its record: the file is damaged");
  const auto taken = rest_.first(static_cast<std::size_t>(size));
  rest_ = rest_.subspan(taken.size());
  return taken;
}

std::uint64_t RecordFields::number(std::size_t size) {
  const auto bytes = take(size);
  std::uint64_t value = 0;
  for (std::size_t i = size; i-- > 0;) value = value << 8 | bytes[i];
  return value;
}

std::string RecordFields::text() {
  constexpr std::size_t kLongest = 1024;
  const auto characters = take(u32());
  if (characters.size() > kLongest)
    throw InputError(place_ + ": a name has " + std::to_string(characters.size()) + " bytes: the file is damaged");
  return {characters.begin(), characters.end()};
}

}  // namespace motorcade::mcap
