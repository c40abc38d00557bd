#include <array>
#include <cstdio>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

/// Looks at the program as it was built, with the readelf that the compiler needs anyway.
namespace motorcade {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

std::string readelf(const std::string& options) {
  const std::string command = "readelf " + options + " '" MOTORCADE_PROGRAM "' 2>&1";
  std::string output;
  std::FILE* const pipe = ::popen(command.c_str(), "r");
  if (!pipe) return output;
  std::array<char, 4096> part;
  while (const std::size_t got = std::fread(part.data(), 1, part.size(), pipe)) output.append(part.data(), got);
  EXPECT_EQ(::pclose(pipe), 0) << output;
  return output;
}

class Hardening : public testing::Test {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__OPTIMIZE__)
    GTEST_SKIP() << "sanitizers take the place of this, and debug builds go without";
#endif
  }
};

TEST_F(Hardening, TheProgramRunsAtAnyAddress) {
  EXPECT_THAT(readelf("-hW"), ContainsRegex("Type: +DYN"));
  EXPECT_THAT(readelf("-dW"), ContainsRegex("FLAGS_1.*PIE"));
}

TEST_F(Hardening, RelocationsAreReadOnlyAndTheStackHoldsNoCode) {
  EXPECT_THAT(readelf("-dW"), ContainsRegex("FLAGS_1.*NOW"));
  const std::string segments = readelf("-lW");
  EXPECT_THAT(segments, HasSubstr("GNU_RELRO"));
  EXPECT_THAT(segments, ContainsRegex("GNU_STACK.* RW "));
  EXPECT_THAT(segments, Not(ContainsRegex("GNU_STACK.*RWE")));
}

TEST_F(Hardening, StackFramesAreProtectedAndTheCLibraryIsFortified) {
  const std::string symbols = readelf("--dyn-syms -W");
  EXPECT_THAT(symbols, HasSubstr("__stack_chk_fail"));
  EXPECT_THAT(symbols, ContainsRegex("__[a-z]+_chk@GLIBC"));
}

}  // namespace
}  // namespace motorcade
