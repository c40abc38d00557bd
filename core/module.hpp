#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

/// Modules: code that few users need and that brings large libraries along. A module is the file `motorcade/NAME.so`
/// beside the library or program that asks for it, and exports one function. No other folder is ever looked into.
namespace motorcade {

/// Failure to find or to load a module: the message names its file and what to do.
struct ModuleError : std::runtime_error {
  using runtime_error::runtime_error;
};

/// Returns a function of the module `name`, loaded by the process's first call; any thread. Throws ModuleError.
void* moduleFunction(const std::string& name, const char* function);

/// Returns the program's own function where it is linked in, else the module's. `linked` is declared [[gnu::weak]]: it
/// is null where it was not linked in.
template <class Function>
Function* linkedOrLoaded(Function* linked, const std::string& name, const char* function) {
  return linked != nullptr ? linked : reinterpret_cast<Function*>(moduleFunction(name, function));
}

/// Full path of the file that an address of this process comes from, however it was named when it was loaded. Empty
/// where the kernel does not tell it (no /proc).
std::filesystem::path fileOfAddress(const void* address);

}  // namespace motorcade
