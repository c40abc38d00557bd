#include "apps/console/own_program.hpp"

#include <CLI/Version.hpp>
#include <Eigen/Core>
#include <jpeglib.h>
#include <libdeflate.h>
#include <lz4.h>
#include <nlohmann/json.hpp>
#include <oneapi/tbb/version.h>
#include <opencv2/core/version.hpp>
#include <png.h>
#include <spdlog/fmt/fmt.h>
#include <spdlog/version.h>
#include <sqlite3.h>
#include <zstd.h>

#include "core/instruction_set.hpp"
#include "io/files/errors.hpp"

namespace motorcade {

std::filesystem::path ownProgram() {
  std::error_code error;
  auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) throw UsageError("this program's file cannot be found: mount /proc");
  return program;
}

namespace {

// libjpeg-turbo defines its version as bare numbers.
#define MOTORCADE_TEXT_OF(value) #value
#define MOTORCADE_TEXT(value) MOTORCADE_TEXT_OF(value)
#ifdef LIBJPEG_TURBO_VERSION
constexpr const char* kJpegName = "libjpeg_turbo";
constexpr const char* kJpegVersion = MOTORCADE_TEXT(LIBJPEG_TURBO_VERSION);
#else
constexpr const char* kJpegName = "libjpeg";
constexpr const char* kJpegVersion = MOTORCADE_TEXT(JPEG_LIB_VERSION);
#endif

#ifdef __clang__
constexpr const char* kCompiler = __VERSION__;
#else
constexpr const char* kCompiler = "GCC " __VERSION__;
#endif

std::string numbered(int major, int minor, int patch) { return fmt::format("{}.{}.{}", major, minor, patch); }

}  // namespace

std::vector<std::pair<std::string, std::string>> versions() {
  return {{"motorcade", MOTORCADE_VERSION},
          {"build", MOTORCADE_BUILD},
          {"compiler", kCompiler},
          {"instruction_set", instructionSet()},
          {"onetbb", TBB_runtime_version()},
          {"eigen", numbered(EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
          {"opencv", CV_VERSION},
          {"libpng", png_get_libpng_ver(nullptr)},
          {"libdeflate", LIBDEFLATE_VERSION_STRING},
          {kJpegName, kJpegVersion},
          {"zstd", ZSTD_VERSION_STRING},
          {"lz4", LZ4_VERSION_STRING},
          {"sqlite", SQLITE_VERSION},
          {"cli11", CLI11_VERSION},
          {"spdlog", numbered(SPDLOG_VER_MAJOR, SPDLOG_VER_MINOR, SPDLOG_VER_PATCH)},
          {"fmt", numbered(FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100)},
          {"nlohmann_json",
           numbered(NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH)}};
}

std::string versionsText() {
  std::string text;
  for (const auto& [name, version] : versions())
    text += text.empty() ? fmt::format("{} {}", name, version) : fmt::format("\n{:<16} {}", name, version);
  return text;
}

}  // namespace motorcade
