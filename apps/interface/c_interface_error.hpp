#pragma once

#include <exception>
#include <new>
#include <string>
#include <type_traits>

#include "motorcade/motorcade.h"
#include "motorcade/motorcade.hpp"

namespace motorcade {

/// A call that is impossible in C++: with a NULL handle, or a struct of an unknown size.
class CallError : public Error {
 public:
  CallError(motorcade_code code, std::string field, const std::string& message)
      : Error(std::move(field), message), code_(code) {}
  motorcade_code code() const { return code_; }

 private:
  motorcade_code code_;
};

/// Keeps the texts for `motorcade_last_error`, cut to its buffer. It takes nothing from the heap, which may be used up.
motorcade_code failed(motorcade_code code, const char* field, const char* message) noexcept;

/// Makes a call of the C interface and catches every exception. A call without a code of its own is OK when it returns.
template <class Call>
motorcade_code guarded(const Call& call) noexcept {
  try {
    if constexpr (std::is_void_v<decltype(call())>)
      return call(), MOTORCADE_OK;
    else
      return call();
  } catch (const CallError& error) {
    return failed(error.code(), error.field().c_str(), error.what());
  } catch (const Error& error) {
    return failed(MOTORCADE_ERROR_VALUE, error.field().c_str(), error.what());
  } catch (const std::bad_alloc&) {
    return failed(MOTORCADE_ERROR_MEMORY, "memory", "memory: there is no more");
  } catch (const std::exception& error) {
    return failed(MOTORCADE_ERROR_INTERNAL, "motorcade", error.what());
  } catch (...) {
    return failed(MOTORCADE_ERROR_INTERNAL, "motorcade", "motorcade: a fault of no known kind");
  }
}

}  // namespace motorcade
