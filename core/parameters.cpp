#include "core/parameters.hpp"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>

namespace motorcade {
namespace {

std::string numberText(double value) {
  if (std::trunc(value) == value && std::abs(value) < 1e15) return std::to_string(static_cast<std::int64_t>(value));
  char digits[32];
  return {digits, std::to_chars(digits, std::end(digits), value).ptr};
}

std::string choicesText(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 < names.size() ? ", " : " or ";
    text += '"' + names[i] + '"';
  }
  return text;
}

/// The value of a number; empty for switches and choices, which are always in range.
std::optional<double> numberIn(const Parameter& parameter) {
  if (const auto* whole = std::get_if<int*>(&parameter.value)) return **whole;
  if (const auto* real = std::get_if<double*>(&parameter.value)) return **real;
  return std::nullopt;
}

}  // namespace

std::string Parameter::allowed() const {
  if (const auto* choice = std::get_if<Choice>(&value)) return choicesText(choice->names);
  if (std::holds_alternative<bool*>(value)) return "true or false";
  return numberText(range.least) + " to " + numberText(range.most);
}

bool Parameter::accepts(double number) const {
  const bool zero_or_normal = number == 0 || std::isnormal(number);
  return zero_or_normal && number >= range.least && number <= range.most;
}

Parameter numberParameter(std::string name, int& value, Range range, std::string gain) {
  return {.name = std::move(name), .value = &value, .gain = std::move(gain), .range = range};
}

Parameter numberParameter(std::string name, double& value, Range range, std::string gain) {
  return {.name = std::move(name), .value = &value, .gain = std::move(gain), .range = range};
}

Parameter switchParameter(std::string name, bool& value, std::string gain) {
  return {.name = std::move(name), .value = &value, .gain = std::move(gain)};
}

std::vector<ParameterProblem> problemsIn(const std::vector<Parameter>& parameters) {
  std::vector<ParameterProblem> problems;
  for (const Parameter& parameter : parameters) {
    const auto number = numberIn(parameter);
    if (number && !parameter.accepts(*number))
      problems.push_back({parameter.name, numberText(*number), parameter.allowed()});
  }
  return problems;
}

}  // namespace motorcade
