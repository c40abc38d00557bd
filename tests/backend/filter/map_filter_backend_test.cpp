#include "backend/filter/map_filter_backend.hpp"

#include <gtest/gtest.h>

#include "tests/backend/simulated_drive.hpp"

namespace motorcade {
namespace {

using test::SimulatedDrive;

TEST(MapFilterBackend, InnovationsMatchTheirCovariance) {
  for (const bool adapt : {false, true}) {
    SimulatedDrive drive(4, {});
    MapFilterBackend::Params params;
    params.adapt_process_noise = adapt;
    MapFilterBackend filter(params);
    const auto result = runDrive(filter, drive);
    ASSERT_EQ(result.finals.size(), 60u);
    const double per_dimension = result.counters.chi2 / (6.0 * static_cast<double>(result.counters.factors));
    std::cout << "filter NIS per dimension " << per_dimension << "\n";
    EXPECT_NEAR(per_dimension, 1.0, 0.25);
  }
}

}  // namespace
}  // namespace motorcade
