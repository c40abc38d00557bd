#include "core/instruction_set.hpp"

#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace motorcade {
namespace {

using testing::ElementsAre;

TEST(InstructionSet, KernelsAreTakenAsTheProcessorAllows) {
  int any = 0, v3 = 0;
  std::array<void*, 3> chosen{&any, &any, &any};
  const std::array<void*, 3> better{&v3, &v3, &v3};
  motorcade_choose_kernels(chosen.data(), better.data(), 2);
  void* const expected = instructionSet() == InstructionSet::kX86V3 ? &v3 : &any;
  EXPECT_THAT(chosen, ElementsAre(expected, expected, &any));
}

}  // namespace
}  // namespace motorcade
