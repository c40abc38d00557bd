#include "core/instruction_set.hpp"

#include <cstdlib>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace motorcade {
namespace {

class InstructionSet : public testing::Test {
 protected:
  ~InstructionSet() override { choose(nullptr); }
  static void choose(const char* name) {
    if (name != nullptr)
      setenv("MOTORCADE_INSTRUCTIONS", name, 1);
    else
      unsetenv("MOTORCADE_INSTRUCTIONS");
    chooseInstructions();
  }
};

TEST_F(InstructionSet, IsTheLeastIfTheEnvironmentWantsAny) {
  const std::string best = instructionSet();
  choose("any");
  const std::string least = instructionSet();
  EXPECT_EQ(least, HWY_ARCH_X86 ? "SSE2" : best);
  choose(least.c_str());
  EXPECT_EQ(instructionSet(), least);
  choose(nullptr);
  EXPECT_EQ(instructionSet(), best);
}

TEST_F(InstructionSet, IsTheOneThatTheEnvironmentWants) {
  const std::string best = instructionSet();
  if (!best.starts_with("AVX")) GTEST_SKIP() << "this processor has no other than " << best;
  for (const char* const lesser : {"SSE4", "AVX2"}) {
    choose(lesser);
    EXPECT_EQ(instructionSet(), lesser);
  }
}

TEST_F(InstructionSet, WithAnUnknownNameTellsTheKnownOnes) {
  try {
    choose("AVX3000");
    FAIL() << "an unknown name was taken";
  } catch (const std::invalid_argument& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("MOTORCADE_INSTRUCTIONS=AVX3000: must be one of any"));
  }
}

}  // namespace
}  // namespace motorcade
