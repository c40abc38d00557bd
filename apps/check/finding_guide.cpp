#include "apps/check/finding_guide.hpp"

#include <algorithm>
#include <utility>

namespace motorcade {
namespace {

constexpr std::string_view kOnRows =
    "A point and its partner in the other image are looked for on one row. A row error of half a pixel loses matches "
    "and bends distances; one of more than a pixel leaves little to build on.";
constexpr std::string_view kRectify =
    "Rectify the images anew with this rig's calibration. If they were rectified, the rig has moved since it was "
    "calibrated: calibrate it again.";

constexpr std::array<std::pair<std::string_view, FindingGuide>, 21> kGuides{{
    {"rows",
     {"The rows of the two images do not agree", kOnRows,
      "Crop both images alike, or rectify them anew: an offset alone is often a crop or a resize that was made "
      "of one image only."}},
    {"roll", {"One image is turned against the other", kOnRows, kRectify}},
    {"zoom",
     {"One image is larger than the other", kOnRows,
      "Let both images have the same focal length: rectify them with one common camera matrix (P0 and P1 with "
      "the same fx)."}},
    {"yaw", {"The cameras do not look in parallel", kOnRows, kRectify}},
    {"lift", {"One camera stands higher than the other", kOnRows, kRectify}},
    {"ahead", {"One camera stands ahead of the other", kOnRows, kRectify}},
    {"distortion",
     {"The lenses' distortion is still in the images",
      "Straight lines are bent, so that distances and directions are wrong toward the corners, by "
      "different amounts as objects cross the image.",
      "Undistort and rectify the images, or give the calibration of the unrectified images, so that they "
      "are rectified while they are read."}},
    {"exchanged",
     {"Left and right are exchanged", "Every point would lie behind the camera: nothing can be followed.",
      "Exchange the two folders, or P0 and P1 of the calibration."}},
    {"apart",
     {"The two images of a pair were not taken at the same time",
      "What moves, and all there is when the camera moves, stands elsewhere in the other image: distances are "
      "those of another moment.",
      "Pair the images by their times, not by their numbers. Look for a frame that one camera dropped, and "
      "let the cameras be triggered together."}},
    {"frozen",
     {"One camera hangs",
      "Its image repeats while the other goes on: they show different moments, and nothing is found in both.",
      "Look at the camera's driver and cable. In a recording, look for copied files."}},
    {"exposure",
     {"The exposure is not steady",
      "Points are followed by how their surroundings look; a jump in brightness loses them.",
      "Fix the exposure, let it change slowly, and let both cameras have the same one."}},
    {"blur",
     {"The images are blurred, smoothed or strongly compressed",
      "Fine texture is what points are made of: there are fewer, and they are less exact.",
      "Look at focus, exposure time, compression, and at denoising in the camera."}},
    {"noise",
     {"The images are noisy", "Points are less exact, and fewer are found.",
      "More light, a longer exposure or less gain."}},
    {"points",
     {"Hardly any point is seen in both images", "Neither the rig can be judged nor anything be followed.",
      "Look at the images: are they dark, blurred, without texture, or not of one rig?"}},
    {"images",
     {"No pair can be used", "There is nothing to follow.",
      "See what was measured: it says of the first pair why. Are these images, of the formats and the size that the "
      "layout asks for?"}},
    {"times",
     {"The times of the pairs jump",
      "Speeds are distances over times: a wrong time is a wrong speed, and a gap loses what was followed.",
      "Look at times.txt (seconds, one line per pair, growing), or leave it out and give the rate with --fps."}},
    {"own_vehicle",
     {"The own vehicle fills much of the image",
      "What lies behind it is not seen, and the points on it are of no use. Once the car moves, it is found by itself "
      "and left out.",
      "Mount the cameras so that they see over it, or cut it off both images."}},
    {"mosaic",
     {"The images are a color sensor's mosaic",
      "Each pixel sees through a filter of one color: a pattern of two by two pixels lies over the texture and stays "
      "where it is while the scene moves.",
      "Give the pattern with --bayer RGGB (BGGR, GRBG, GBRG), or convert the images to gray or color."}},
    {"pairs",
     {"Images are missing, or their names do not tell which belong together",
      "An image whose partner is another moment's gives distances of nothing. A frame without images has a predicted "
      "pose, and what moved meanwhile is lost after some of them.",
      "Look at what the recording left out. Give the images of a pair the same number or time in their names, or list "
      "the pairs: LEFT RIGHT in each line of a text file."}},
    {"calibration",
     {"The calibration cannot be that of these images",
      "Distances come from focal length and baseline: all of them would be off by a factor.",
      "Look at the units (meters, pixels) and at the image size that the calibration was made for."}},
    {"camera",
     {"The calibration is unusual", "It may be right, but few cameras have such numbers.",
      "Look at what the images were cut and squeezed to after the calibration was made."}},
}};

}  // namespace

FindingGuide guideTo(std::string_view finding) {
  const auto found = std::ranges::find(kGuides, finding, [](const auto& entry) { return entry.first; });
  if (found != kGuides.end()) return found->second;
  return {finding, "Results would be less exact, or none.", "See what was measured."};
}

bool isWorthless(std::span<const Finding> findings) { return std::ranges::any_of(findings, &Finding::worthless); }

std::string verdictOnRun(std::span<const Finding> findings) {
  constexpr std::array kNothingToFollow{std::string_view("images"), std::string_view("points")};
  if (!isWorthless(findings))
    return "run takes this drive; it looks on for changes of the rig, and ends with exit code 3 where one makes "
           "results "
           "worthless";
  const bool nothing = std::ranges::any_of(findings, [&](const Finding& finding) {
    return finding.worthless && std::ranges::find(kNothingToFollow, finding.name) != kNothingToFollow.end();
  });
  return nothing ? "run ends with exit code 3: it finds nothing to follow"
                 : "run ends with exit code 3; run --force goes on";
}

}  // namespace motorcade
