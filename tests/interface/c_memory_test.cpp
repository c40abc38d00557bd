#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "motorcade/motorcade.h"
#include "tests/interface/c_handles.hpp"
#include "tests/support/replaced_heap.hpp"

namespace {

thread_local bool heap_is_used_up = false;

/// Gives this thread no memory while it lives.
class UsedUpHeap {
 public:
  UsedUpHeap() { heap_is_used_up = true; }
  ~UsedUpHeap() { heap_is_used_up = false; }
  UsedUpHeap(const UsedUpHeap&) = delete;
  UsedUpHeap& operator=(const UsedUpHeap&) = delete;
};

}  // namespace

bool heapTaken() { return !heap_is_used_up; }
void heapGiven() {}

namespace motorcade {
namespace {

using test::sized;

TEST(CInterfaceMemory, WithoutAnyACallSaysSoAndLosesNoResult) {
  const auto options = test::replayOptions();
  const auto tracker = test::trackerOf(test::plainCamera(), &options);
  const std::vector<std::uint8_t> pixels(std::size_t{128} * 96, 100);
  auto image = sized<motorcade_image>();
  image.pixels = pixels.data();
  image.width_px = 128;
  image.height_px = 96;
  auto pair = sized<motorcade_pair>();
  pair.left = pair.right = &image;
  auto push = sized<motorcade_push>();
  ASSERT_EQ(motorcade_tracker_push(tracker.get(), &pair, &push), MOTORCADE_OK);
  ASSERT_EQ(push.status, MOTORCADE_PUSH_ACCEPTED) << push.why;

  motorcade_result* result = nullptr;
  motorcade_code code = MOTORCADE_OK;
  {
    const UsedUpHeap heap;
    code = motorcade_tracker_wait(tracker.get(), 60'000, &result);
  }
  EXPECT_EQ(code, MOTORCADE_ERROR_MEMORY);
  EXPECT_EQ(result, nullptr);
  EXPECT_STREQ(motorcade_last_error_field(), "memory");
  EXPECT_NE(test::taken(tracker.get()), nullptr);
}

TEST(CInterfaceMemory, WithoutAnyOptionsAreNotRead) {
  const std::vector<int> cpus{0};
  auto options = test::replayOptions();
  options.cpus = cpus.data();
  options.cpu_count = cpus.size();
  const auto camera = test::plainCamera();
  motorcade_tracker* tracker = nullptr;
  motorcade_code code = MOTORCADE_OK;
  {
    const UsedUpHeap heap;
    code = motorcade_tracker_create(&camera, &options, &tracker);
  }
  EXPECT_EQ(code, MOTORCADE_ERROR_MEMORY);
  EXPECT_EQ(tracker, nullptr);
}

}  // namespace
}  // namespace motorcade
