#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "io/files/errors.hpp"
#include "io/files/json_text.hpp"
#include "io/files/text_file.hpp"

/// JSON helpers that plans and records share.
namespace motorcade {

using Json = nlohmann::ordered_json;

template <class Value>
Json orNull(const std::optional<Value>& value) {
  return value ? Json(*value) : Json();
}

inline std::optional<std::uint32_t> seedOf(const Json& json) {
  const Json& seed = json.at("seed");
  return seed.is_null() ? std::nullopt : std::optional(seed.get<std::uint32_t>());
}

inline std::string textOf(const Json& json) { return jsonText(json, 1) + '\n'; }

/// Throws InputError that says that the file is not `what`.
template <class Value, class Convert>
Value readJson(const std::filesystem::path& file, const std::string& what, const Convert& convert) {
  try {
    return convert(parsedOrderedJson(readWhole(file)));
  } catch (const nlohmann::json::exception& error) {
    throw InputError(file.string() + ": is not " + what + " (" + printable(error.what(), 100) + ")");
  }
}

}  // namespace motorcade
