#include "frontend/features/sift_module.hpp"

#include <algorithm>
#include <exception>
#include <new>

#include <opencv2/features2d.hpp>

namespace motorcade {
namespace {

// Parameters of Lowe (2004): three scales per octave, and a contrast threshold that OpenCV divides by their number.
constexpr int kOctaveLayers = 3;
constexpr double kContrastThreshold = 0.03;

void detect(const SiftImage& image, int max_points, std::vector<SiftKeypoint>& keypoints) {
  const cv::Mat view(image.height_px, image.width_px, CV_8UC1, const_cast<std::uint8_t*>(image.pixels),
                     static_cast<std::size_t>(image.stride_bytes));
  std::vector<cv::KeyPoint> found;
  cv::Mat descriptors;
  cv::SIFT::create(max_points, kOctaveLayers, kContrastThreshold)
      ->detectAndCompute(view, cv::noArray(), found, descriptors);
  for (int i = 0; i < static_cast<int>(found.size()); ++i) {
    const cv::KeyPoint& point = found[i];
    // Keypoints at the same position with different orientations follow one another and are one point.
    if (!keypoints.empty() && keypoints.back().u_px == point.pt.x && keypoints.back().v_px == point.pt.y) continue;
    SiftKeypoint& keypoint = keypoints.emplace_back(
        SiftKeypoint{.u_px = point.pt.x, .v_px = point.pt.y, .response = point.response, .descriptor = {}});
    std::copy_n(descriptors.ptr<float>(i), keypoint.descriptor.size(), keypoint.descriptor.begin());
  }
}

}  // namespace

extern "C" [[gnu::visibility("default")]] void motorcade_sift_1(const SiftImage& image, int max_points,
                                                                std::vector<SiftKeypoint>& keypoints,
                                                                std::string& problem) noexcept {
  try {
    detect(image, max_points, keypoints);
  } catch (const std::bad_alloc&) {
    problem = "out of memory";  // short enough to need none
  } catch (const std::exception& error) {
    problem = error.what();
  }
}

}  // namespace motorcade
