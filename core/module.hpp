#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

/// Modules: code that brings large libraries along and that few need. A module is the file `motorcade/NAME.so` in the
/// folder of the library or program that asks for it, and exports one function. No other folder is ever looked into.
namespace motorcade {

/// A module that is not there, or cannot be loaded: the message names its file and what to do.
struct ModuleError : std::runtime_error {
  using runtime_error::runtime_error;
};

/// Of the module `name`, loaded by the first call in the process; from any thread. Throws ModuleError.
void* moduleFunction(const std::string& name, const char* function);

/// The function where the program holds it already, else the module's. `linked` is declared [[gnu::weak]]: null where
/// it was not linked in.
template <class Function>
Function* linkedOrLoaded(Function* linked, const std::string& name, const char* function) {
  return linked != nullptr ? linked : reinterpret_cast<Function*>(moduleFunction(name, function));
}

/// The file that an address of this process comes from, by its full path however it was named when it was loaded; empty
/// where the kernel does not tell (no /proc).
std::filesystem::path fileOfAddress(const void* address);

}  // namespace motorcade
