#include "io/files/json_text.hpp"

#include <nlohmann/json.hpp>

namespace motorcade {

nlohmann::json parsedJson(std::string_view text) { return nlohmann::json::parse(text); }

nlohmann::ordered_json parsedOrderedJson(std::string_view text) { return nlohmann::ordered_json::parse(text); }

nlohmann::json jsonOrDiscarded(std::string_view text) {
  return nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
}

std::string jsonText(const nlohmann::ordered_json& json, int indent) {
  return json.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace motorcade
