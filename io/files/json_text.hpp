#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

/// JSON from text and as text. Both are compiled here alone: they cost the compiler a second wherever they are used.
namespace motorcade {

/// Throws nlohmann::json::exception.
nlohmann::json parsedJson(std::string_view text);
nlohmann::ordered_json parsedOrderedJson(std::string_view text);

/// `is_discarded()` where the text is no JSON.
nlohmann::json jsonOrDiscarded(std::string_view text);

/// Writes JSON on one line, or with `indent` spaces per level. Bytes that are not UTF-8, as in file names, are
/// replaced.
std::string jsonText(const nlohmann::ordered_json& json, int indent = -1);

}  // namespace motorcade
