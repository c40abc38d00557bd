#include "apps/evaluate/report/report.hpp"

namespace motorcade {

std::string legendOf(const Evaluation& evaluation) {
  std::string text =
      "\nATE        distance from the truth, after SE(3) alignment; 1st pose: aligned by the first pose alone\n"
      "RPE        error of the motion from one frame to the next: _t translation, _r rotation\n"
      "ARE        error of the rotation; end error: of the last position, share of the path's length\n";
  if (evaluation.final.camera_segments || evaluation.online.camera_segments)
    text +=
        "segments   one of each length begins in every tenth frame and ends in the first frame beyond it;\n"
        "           the error of its motion, divided by the length: KITTI's published figures are the mean\n"
        "           of all from 100 to 800 m\n";
  if (!evaluation.object_source.empty())
    text +=
        "position   aligned: after SE(3) alignment of the object's path; offset: in the world, without the\n"
        "           constant offset between body and label; as seen: the same from the frame's camera\n"
        "drift      how far the body's origin wanders along the label's length, height and width\n"
        "ids        tracks that followed the label; id switches: changes from one of them to another\n"
        "ME         as RPE, of an object's motion; all followed: also labels that are hidden or small, and\n"
        "           predicted rows; p95: 95 of 100 steps have less; objects' mean: of each object's root\n"
        "           mean square, the form of published figures\n"
        "false      rows on what does not move or is not there\n"
        "MOTA       1 - (misses + false rows + id switches) / labels\n"
        "IoU        intersection over union with the label's box, cuboid or mask: 1 where they agree\n"
        "log loss   mean of -log p of a kind that is right, -log(1 - p) of a wrong one, log 2 of unknown;\n"
        "           surely wrong: of a probability of 0.95 and more\n"
        "HOTA       tracking accuracy, of detection (Det) and association (Ass), each with recall (Re)\n"
        "           and precision (Pr), and of localization (Loc): 1 is perfect\n";
  const CovarianceEvaluation& covariances = evaluation.online.covariances;
  if (covariances.camera.samples + covariances.objects.samples > 0)
    text += "NEES       squared error in units of its covariance; in: share within the region of 95 %\n";
  return text + "docs/formats.md says more of each measure, and what --json adds.\n";
}

}  // namespace motorcade
