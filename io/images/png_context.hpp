#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <string_view>

#include <png.h>

namespace motorcade {

/// State of libpng's callbacks: the rest of the file to read (`bytes`) and the message of an error. libpng reports
/// errors by jumping: no function between `setjmp` and the jump owns anything.
struct PngContext {
  std::string_view bytes;
  std::array<char, 128> message{};

  static void read(png_structp png, png_bytep to, std::size_t count) {
    auto& context = *static_cast<PngContext*>(png_get_io_ptr(png));
    if (context.bytes.size() < count) png_error(png, "the file ends early");
    std::memcpy(to, context.bytes.data(), count);
    context.bytes.remove_prefix(count);
  }
  [[noreturn]] static void fail(png_structp png, png_const_charp text) {
    auto& context = *static_cast<PngContext*>(png_get_error_ptr(png));
    std::strncpy(context.message.data(), text, context.message.size() - 1);
    png_longjmp(png, 1);
  }
  static void warn(png_structp, png_const_charp) {}
};

}  // namespace motorcade
