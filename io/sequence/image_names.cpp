#include "io/sequence/image_names.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

#include "io/files/errors.hpp"
#include "io/files/file_names.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kDigitLetters = "0123456789";

std::string joined(const NameParts& parts) {
  std::string name;
  for (const std::string& part : parts) name += part;
  return name;
}

/// The text of a name, with a mark for digits.
std::string nameKindOf(const NameParts& parts) {
  std::string kind;
  for (std::size_t i = 0; i < parts.size(); ++i) kind += i % 2 == 0 ? parts[i] : "#";
  return kind;
}

std::string withoutZeros(const std::string& digits) {
  return digits.substr(std::min(digits.find_first_not_of('0'), digits.size()));
}

/// The kind that all names but a few have; empty where there is none.
std::optional<std::string> usualKind(const std::vector<NameParts>& names) {
  constexpr std::size_t kFewest = 3, kMany = 5;  // strays are at most one name in so many
  std::map<std::string, std::size_t> counts;
  for (const NameParts& name : names) ++counts[nameKindOf(name)];
  const auto usual =
      std::ranges::max_element(counts, {}, [](const auto& kind_and_count) { return kind_and_count.second; });
  if (counts.size() == 1) return usual->first;
  const std::size_t strays = names.size() - usual->second;
  const bool few = strays == 1 || kMany * strays <= names.size();
  return few && usual->second >= kFewest ? std::optional(usual->first) : std::nullopt;
}

std::optional<std::int64_t> numberIn(const std::string& digits) {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  return error == std::errc() ? std::optional(number) : std::nullopt;
}

void insert(ImagesByNumber& images, std::int64_t number, const fs::path& image) {
  const auto [place, is_new] = images.emplace(number, image);
  if (!is_new)
    throw InputError(image.string() + ": has the same number as " + place->second.filename().string() +
                     "; leave one of them in the folder");
}

/// Numbers the images of both sides; false where a number is too large.
bool insertNumbers(ImagesByNumber& images, const NamedImages& side, std::size_t part) {
  for (std::size_t i = 0; i < side.images.size(); ++i) {
    const auto number = numberIn(side.names[i][part]);
    if (!number) return false;
    insert(images, *number, side.images[i]);
  }
  return true;
}

/// The parts of a name that distinguish it from others of its side; the whole name where these are not known.
NameParts keyOf(const NameParts& name, const std::optional<std::set<std::size_t>>& varying) {
  if (!varying) return {joined(name)};
  NameParts key;
  for (const std::size_t part : *varying) key.push_back(withoutZeros(name[part]));
  return key;
}

struct InOrderOfParts {
  bool operator()(const NameParts& a, const NameParts& b) const {
    return std::ranges::lexicographical_compare(a, b, naturallyBefore);
  }
};

/// Keys each image by the place of its name in the natural order of the names of both sides together.
KeyedImages byNames(const NamedImages& left, const NamedImages& right,
                    const std::optional<std::pair<std::set<std::size_t>, std::set<std::size_t>>>& varying) {
  const auto of_left = varying ? std::optional(varying->first) : std::nullopt,
             of_right = varying ? std::optional(varying->second) : std::nullopt;
  std::map<NameParts, std::int64_t, InOrderOfParts> places;
  for (const NameParts& name : left.names) places.emplace(keyOf(name, of_left), 0);
  for (const NameParts& name : right.names) places.emplace(keyOf(name, of_right), 0);
  std::int64_t next = 0;
  for (auto& [key, place] : places) place = next++;
  KeyedImages keyed;
  for (std::size_t i = 0; i < left.images.size(); ++i)
    insert(keyed.left, places.at(keyOf(left.names[i], of_left)), left.images[i]);
  for (std::size_t i = 0; i < right.images.size(); ++i)
    insert(keyed.right, places.at(keyOf(right.names[i], of_right)), right.images[i]);
  return keyed;
}

std::optional<KeyedImages> byTimes(const NamedImages& left, const NamedImages& right) {
  const auto left_times = timesOfNames(left.names), right_times = timesOfNames(right.names);
  if (!left_times || !right_times || left_times->unit_ns != right_times->unit_ns) return std::nullopt;
  KeyedImages keyed{.kind = NameKind::kTimes};
  for (std::size_t i = 0; i < left.images.size(); ++i) insert(keyed.left, left_times->all_ns[i], left.images[i]);
  for (std::size_t i = 0; i < right.images.size(); ++i) insert(keyed.right, right_times->all_ns[i], right.images[i]);
  return keyed;
}

/// The digits that distinguish the names of each side. Where both sides have as many parts, digits that vary on either
/// side count for both.
std::pair<std::set<std::size_t>, std::set<std::size_t>> tellingDigits(const NamedImages& left,
                                                                      const NamedImages& right) {
  auto of_left = varyingDigits(left.names), of_right = varyingDigits(right.names);
  if (left.names.front().size() == right.names.front().size()) {
    of_left.insert(of_right.begin(), of_right.end());
    of_right = of_left;
  }
  return {of_left, of_right};
}

}  // namespace

std::optional<std::int64_t> imageNumber(const fs::path& image) {
  const std::string name = image.stem().string();
  const std::size_t begin = name.find_last_not_of("0123456789") + 1;
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(name.data() + begin, name.data() + name.size(), number);
  if (begin == name.size() || error != std::errc()) return std::nullopt;
  return number;
}

NameParts partsOfName(std::string_view name) {
  NameParts parts;
  while (parts.empty() || !name.empty()) {
    const bool digits = parts.size() % 2 == 1;
    const std::size_t end = digits ? name.find_first_not_of(kDigitLetters) : name.find_first_of(kDigitLetters);
    parts.emplace_back(name.substr(0, end));
    name.remove_prefix(std::min(end, name.size()));
  }
  return parts;
}

NamedImages namedImages(const std::vector<fs::path>& images) {
  NamedImages named{.images = images};
  for (const fs::path& image : images) named.names.push_back(partsOfName(image.stem().string()));
  if (images.empty()) return named;
  const auto usual = usualKind(named.names);
  named.alike = usual.has_value();
  if (!usual) return named;
  const NamedImages all = std::exchange(named, {});
  for (std::size_t i = 0; i < images.size(); ++i) {
    const bool stray = nameKindOf(all.names[i]) != *usual;
    (stray ? named.strays : named.images).push_back(images[i]);
    if (!stray) named.names.push_back(all.names[i]);
  }
  return named;
}

std::set<std::size_t> varyingDigits(const std::vector<NameParts>& names) {
  std::set<std::size_t> varying;
  for (const NameParts& name : names)
    for (std::size_t part = 1; part < name.size(); part += 2)
      if (withoutZeros(name[part]) != withoutZeros(names.front()[part])) varying.insert(part);
  return varying;
}

KeyedImages keyedImages(const NamedImages& left, const NamedImages& right) {
  if (!left.alike || !right.alike) return byNames(left, right, std::nullopt);
  if (auto keyed = byTimes(left, right)) return *std::move(keyed);
  const auto [of_left, of_right] = tellingDigits(left, right);
  if (of_left.size() != of_right.size()) return byNames(left, right, std::nullopt);
  KeyedImages keyed{.kind = NameKind::kNumbers};
  if (of_left.size() == 1 && insertNumbers(keyed.left, left, *of_left.begin()) &&
      insertNumbers(keyed.right, right, *of_right.begin()))
    return keyed;
  return byNames(left, right, std::pair(of_left, of_right));
}

fs::path expectedImage(const NamedImages& side, const NamedImages& other, const fs::path& partner) {
  const fs::path& example = side.images.front();
  fs::path like_partner = example.parent_path() / partner.filename().replace_extension(example.extension());
  if (!side.alike || !other.alike) return like_partner;
  const auto [of_side, of_other] = tellingDigits(side, other);
  if (of_side.size() != of_other.size()) return like_partner;
  const NameParts from = partsOfName(partner.stem().string());
  NameParts name = side.names.front();
  for (auto part = of_side.begin(), source = of_other.begin(); part != of_side.end(); ++part, ++source) {
    const std::size_t width = name[*part].size();
    const bool padded =
        std::ranges::all_of(side.names, [&](const NameParts& each) { return each[*part].size() == width; });
    std::string digits = withoutZeros(from[*source]);
    const std::size_t least = padded ? width : 1;
    if (digits.size() < least) digits.insert(0, least - digits.size(), '0');
    name[*part] = digits;
  }
  return example.parent_path() / (joined(name) + example.extension().string());
}

}  // namespace motorcade
