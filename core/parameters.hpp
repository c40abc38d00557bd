#pragma once

#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

/// Parameters that a user may set. A stage declares, beside its `Params`,
///
///   std::vector<Parameter> parametersOf(Params& params);
///
/// which binds each field to its name, its range and what a user gains by it. Ranges stand only there: the
/// configuration, the constructors (`requireValid`) and the tests all read them from there.
namespace motorcade {

/// Inclusive bounds. They are always finite, so infinite, huge and denormal values lie outside every range.
struct Range {
  double least, most;
};

/// A parameter that takes one of a few names.
struct Choice {
  std::vector<std::string> names;
  std::function<std::size_t()> get;
  std::function<void(std::size_t)> set;
};

/// A field of a `Params` struct that a user may set. It refers to the struct, which must outlive it.
struct Parameter {
  std::string name;
  std::variant<int*, double*, bool*, Choice> value;
  std::string gain;   // what a user gains by setting it, in a few words
  Range range{0, 0};  // of numbers
  /// Describes the accepted values, for messages and comments: `1 to 16`, `"corners" or "sift"`, ...
  std::string allowed() const;
  bool accepts(double number) const;
};

Parameter numberParameter(std::string name, int& value, Range range, std::string gain);
Parameter numberParameter(std::string name, double& value, Range range, std::string gain);
Parameter switchParameter(std::string name, bool& value, std::string gain);
template <class Enum>
Parameter choiceParameter(std::string name, Enum& value, const std::vector<std::pair<std::string, Enum>>& choices,
                          std::string gain);

/// A parameter out of its range.
struct ParameterProblem {
  std::string name, value, allowed;
  std::string text() const { return "'" + name + "' is " + value + "; write " + allowed; }
};
std::vector<ParameterProblem> problemsIn(const std::vector<Parameter>& parameters);

template <class Params>
std::vector<ParameterProblem> problemsOf(Params params) {
  return problemsIn(parametersOf(params));
}

/// Returns the parameters, for constructors. Throws std::invalid_argument with parameter and range when one is out of
/// range.
template <class Params>
const Params& requireValid(const Params& params) {
  const auto problems = problemsOf(params);
  if (!problems.empty()) throw std::invalid_argument(problems.front().text());
  return params;
}

template <class Enum>
Parameter choiceParameter(std::string name, Enum& value, const std::vector<std::pair<std::string, Enum>>& choices,
                          std::string gain) {
  Choice choice;
  for (const auto& [choice_name, choice_value] : choices) choice.names.push_back(choice_name);
  choice.get = [&value, choices] {
    std::size_t index = 0;
    while (choices[index].second != value) ++index;
    return index;
  };
  choice.set = [&value, choices](std::size_t index) { value = choices[index].second; };
  return {.name = std::move(name), .value = std::move(choice), .gain = std::move(gain)};
}

}  // namespace motorcade
