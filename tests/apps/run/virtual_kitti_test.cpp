#include <gmock/gmock.h>

#include "io/layouts/open_sequence.hpp"
#include "tests/apps/program_run.hpp"
#include "tests/support/data_folder.hpp"
#include "tests/support/virtual_kitti_drive.hpp"

/// Compares a rendered drive that is laid out as Virtual KITTI 2 with the same drive in its own layout: runs and
/// measures.
namespace motorcade::test {
namespace {

/// Compares numbers, which may differ by no more than printing does, each by its place.
void expectNear(const nlohmann::json& a, const nlohmann::json& b, const std::string& place) {
  constexpr double kTolerance = 1e-5;  // of sums of values that were printed with twelve digits
  ASSERT_EQ(a.type() == nlohmann::json::value_t::null, b.type() == nlohmann::json::value_t::null) << place;
  if (a.is_structured()) {
    ASSERT_EQ(a.size(), b.size()) << place;
    for (const auto& [key, value] : a.items())
      if (a.is_object())
        expectNear(value, b.at(key), place + "/" + key);
      else
        expectNear(value, b.at(std::stoul(key)), place + "/" + key);
  } else if (a.is_number()) {
    EXPECT_NEAR(a.get<double>(), b.get<double>(), kTolerance * std::max(1.0, std::abs(a.get<double>()))) << place;
  } else {
    EXPECT_EQ(a, b) << place;
  }
}

std::string cameraOption(const StereoCamera& camera) {
  std::ostringstream text;
  text << camera.fx_px << ',' << camera.fy_px << ',' << camera.cx_px << ',' << camera.cy_px << ',' << camera.baseline_m;
  return text.str();
}

class VirtualKitti : public Run {
 protected:
  /// Runs a drive in both forms and compares these parts of their measures.
  void expectTheSame(const fs::path& folder, const std::vector<std::string>& parts) {
    auto drive = virtualKittiDriveOf(folder);
    ASSERT_TRUE(drive);
    drive->T_map_world = SE3(Eigen::AngleAxisd(2.1, Eigen::Vector3d(0.02, 1, -0.01).normalized()).toRotationMatrix(),
                             {53.2, -106, 79.9});
    const fs::path variation = out("Scene01") / "clone";
    drive->write(variation);
    const StereoCamera as_read = openSequence(variation).camera;
    EXPECT_NEAR(as_read.fx_px, drive->sequence.camera.fx_px, 1e-9);
    EXPECT_NEAR(as_read.baseline_m, drive->sequence.camera.baseline_m, 1e-9);
    // The last digits of a baseline that was printed would change those of the results.
    const std::string options = "--masks --camera " + cameraOption(drive->sequence.camera);
    ASSERT_EQ(run("plain", options, folder), 0) << contentOf(errors());
    ASSERT_EQ(run("virtual", options, variation), 0) << contentOf(errors());
    expectSame("plain", "virtual");
    const auto plain = evaluate("plain", folder), as_virtual = evaluate("virtual", variation);
    EXPECT_GT(plain["final"]["motion"]["me_t_m"]["count"].get<int>(), 0);
    EXPECT_GT(plain["masks"]["within_30m"]["rows_with_mask"].get<int>(), 0);
    for (const std::string& part : parts) {
      const nlohmann::json::json_pointer place(part);
      expectNear(plain.at(place), as_virtual.at(place), part);
    }
    EXPECT_EQ(as_virtual["truth"]["objects"], "pose.txt and bbox.txt");
  }
};

TEST_F(VirtualKitti, ARenderedDriveIsMeasuredAsInItsOwnLayout) {
  expectTheSame(kSequence, {"/final", "/online", "/masks", "/covariance", "/worst_frames"});
}

/// Labels do not tell what is hidden, so that other objects count.
TEST_F(VirtualKitti, TheCameraOfADriveOfAnotherRendererIsMeasuredAsInItsOwnLayout) {
  const fs::path street = dataFolder() / "rendered_street";
  if (!fs::exists(street)) GTEST_SKIP() << street << " is not there";
  expectTheSame(street, {"/final/camera", "/online/camera", "/covariance/camera"});
}

}  // namespace
}  // namespace motorcade::test
