#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <pybind11/pybind11.h>

namespace motorcade::python {

template <class Value>
constexpr const char* kWanted = "a number";
template <>
inline constexpr const char* kWanted<int> = "an integer";
template <>
inline constexpr const char* kWanted<std::int64_t> = "an integer of 64 bits";
template <>
inline constexpr const char* kWanted<bool> = "True or False";
template <>
inline constexpr const char* kWanted<std::vector<int>> = "a sequence of integers";
template <>
inline constexpr const char* kWanted<std::string> = "a str";

/// The value of a Python object. Throws TypeError, which calls it `field` and says what is wanted.
template <class Value>
Value valueOf(const pybind11::handle& object, const std::string& field) {
  try {
    return object.cast<Value>();
  } catch (const pybind11::cast_error&) {
    throw pybind11::type_error(field + ": is " + pybind11::repr(object).cast<std::string>() + "; it is " +
                               kWanted<Value>);
  }
}

}  // namespace motorcade::python
