#include "apps/pipeline/parameter_table.hpp"

#include <cmath>
#include <utility>

#include "apps/pipeline/configuration.hpp"
#include "frontend/image/window_differences.hpp"

namespace motorcade {
namespace {

struct Range {
  double least, most = std::numeric_limits<double>::infinity();
};
constexpr Range kAnyCount{0}, kAtLeastOne{1}, kNotNegative{0}, kShare{0, 1};
constexpr Range kPositive{std::numeric_limits<double>::denorm_min()};

/// Collects the parameters of one section.
class Section {
 public:
  Section(std::vector<Parameter>& table, std::string name) : table_(table), name_(std::move(name)) {}

  template <class Number>
  Section& add(const char* name, Number& value, Range range) {
    table_.push_back({name_, name, &value, range.least, range.most});
    return *this;
  }
  Section& add(const char* name, bool& value) {
    table_.push_back({.section = name_, .name = name, .value = &value});
    return *this;
  }
  template <class Enum>
  Section& add(const char* name, Enum& value, std::vector<std::pair<std::string, Enum>> choices) {
    std::vector<std::string> names;
    std::vector<Enum> values;
    for (auto& [choice_name, choice_value] : choices) {
      names.push_back(choice_name);
      values.push_back(choice_value);
    }
    const auto get = [&value, values] {
      std::size_t index = 0;
      while (values[index] != value) ++index;
      return index;
    };
    const auto set = [&value, values](std::size_t index) { value = values[index]; };
    table_.push_back({.section = name_, .name = name, .value = Choice{std::move(names), get, set}});
    return *this;
  }

 private:
  std::vector<Parameter>& table_;
  std::string name_;
};

void addPipeline(std::vector<Parameter>& table, PipelineParams& p) {
  Section(table, "pipeline")
      .add("threads", p.threads, {1, 64})
      .add("frames_in_flight", p.frames_in_flight, {1, 64})
      .add("policy", p.policy, {{"replay", InputPolicy::kReplay}, {"live", InputPolicy::kLive}});
}

void addPatch(Section section, PatchParams& p) {
  section.add("window_px", p.window_px, {3, kMaxPatchWindow_px})
      .add("max_iterations", p.max_iterations, {1, 100})
      .add("max_step_px", p.max_step_px, kPositive)
      .add("max_shift_px", p.max_shift_px, kPositive)
      .add("min_ncc", p.min_ncc, kShare)
      .add("sigma_floor_px", p.sigma_floor_px, kPositive);
}

void addDisparity(Section section, DisparityParams& p) {
  section.add("window_px", p.window_px, {3, kMaxPatchWindow_px})
      .add("search_radius_px", p.search_radius_px, {0, 100})
      .add("max_iterations", p.max_iterations, {1, 100})
      .add("min_ncc", p.min_ncc, kShare)
      .add("sigma_floor_px", p.sigma_floor_px, kPositive)
      .add("max_sigma_px", p.max_sigma_px, kPositive);
}

void addPoseFit(Section section, PoseFitParams& p) {
  section.add("max_iterations", p.max_iterations, {1, 100})
      .add("huber_sigmas", p.huber_sigmas, kPositive)
      .add("outlier_chi2", p.outlier_chi2, kPositive)
      .add("min_step", p.min_step, kPositive);
}

void addPreparation(std::vector<Parameter>& table, FeaturePreparation::Params& p) {
  Section(table, "frontend")
      .add("detector", p.detector, {{"corners", DetectorKind::kCorners}, {"sift", DetectorKind::kSift}})
      .add("pyramid_levels", p.pyramid_levels, {1, 8});
  Section(table, "frontend.corners")
      .add("max_corners", p.corners.max_corners, {1, 100'000})
      .add("cell_px", p.corners.cell_px, {4, 1000})
      .add("max_per_cell", p.corners.max_per_cell, {1, 1000})
      .add("min_score", p.corners.min_score, kNotNegative)
      .add("min_score_over_grain", p.corners.min_score_over_grain, kNotNegative)
      .add("border_px", p.corners.border_px, {4, 1000})
      .add("min_distance_px", p.corners.min_distance_px, {1, 100});
  Section(table, "frontend.sift")
      .add("max_points", p.sift.max_points, {1, 100'000})
      .add("contrast_threshold", p.sift.contrast_threshold, kNotNegative);
}

void addStereo(std::vector<Parameter>& table, StereoMatcher::Params& p) {
  Section(table, "frontend.stereo")
      .add("min_disparity_px", p.min_disparity_px, kPositive)
      .add("max_disparity_px", p.max_disparity_px, {8, kMaxWindowCosts - 2})
      .add("search_columns", p.search_columns, {3, kMaxWindowColumns})
      .add("search_rows", p.search_rows, {3, kMaxWindowRows})
      .add("max_uniqueness_ratio", p.max_uniqueness_ratio, kShare)
      .add("max_round_trip_px", p.max_round_trip_px, {0, 100})
      .add("sift_max_row_px", p.sift_max_row_px, kPositive)
      .add("sift_max_ratio", p.sift_max_ratio, kShare)
      .add("sift_sigma_px", p.sift_sigma_px, kPositive);
  addDisparity(Section(table, "frontend.stereo.refinement"), p.refinement);
}

void addOpticalFlow(std::vector<Parameter>& table, OpticalFlowTracker::Params& p) {
  Section(table, "frontend.optical_flow")
      .add("max_tracks", p.max_tracks, {1, 100'000})
      .add("cell_px", p.cell_px, {4, 1000})
      .add("min_distance_px", p.min_distance_px, {0, 100})
      .add("max_round_trip_px", p.max_round_trip_px, kPositive)
      .add("max_flow_px", p.max_flow_px, kPositive)
      .add("border_px", p.border_px, {0, 1000})
      .add("keyframe_frames", p.keyframe_frames, {1, 1000})
      .add("keyframe_max_ncc_loss", p.keyframe_max_ncc_loss, kShare)
      .add("keyframe_max_drift_px", p.keyframe_max_drift_px, kPositive)
      .add("moving_level", p.moving_level, {0, 7})
      .add("young_level", p.young_level, {0, 7})
      .add("young_margin_px", p.young_margin_px, kNotNegative)
      .add("far_margin_px", p.far_margin_px, kNotNegative)
      .add("far_max_difference", p.far_max_difference, {0, 255})
      .add("sift_max_flow_px", p.sift_max_flow_px, kPositive)
      .add("sift_max_ratio", p.sift_max_ratio, kShare)
      .add("sift_sigma_px", p.sift_sigma_px, kPositive);
  addPatch(Section(table, "frontend.optical_flow.patch"), p.patch);
}

void addSceneMotion(std::vector<Parameter>& table, SceneMotionEstimator::Params& p) {
  Section(table, "frontend.motion")
      .add("neighbour_px", p.neighbour_px, kNotNegative)
      .add("unpredicted_search", p.unpredicted_search, kNotNegative)
      .add("sigma_flow_px", p.sigma_flow_px, kPositive)
      .add("sigma_disparity_px", p.sigma_disparity_px, kPositive)
      .add("max_missed_frames", p.max_missed_frames, kAnyCount)
      .add("static_chi2_per_dof", p.static_chi2_per_dof, kPositive)
      .add("repeat_check_chi2", p.repeat_check_chi2, kPositive)
      .add("max_ground_noise_m", p.max_ground_noise_m, kPositive)
      .add("lost_sigma_m", p.lost_sigma_m, kPositive)
      .add("lost_sigma_rad", p.lost_sigma_rad, kPositive)
      .add("calibration_frames", p.calibration_frames, kAnyCount);
  addDisparity(Section(table, "frontend.motion.disparity"), p.disparity);
  Section(table, "frontend.motion.repeated_texture")
      .add("window_px", p.repeated_texture.window_px, {3, kMaxPatchWindow_px})
      .add("min_ncc", p.repeated_texture.min_ncc, kShare)
      .add("max_prediction_px", p.repeated_texture.max_prediction_px, kPositive)
      .add("min_separation_px", p.repeated_texture.min_separation_px, kPositive);
  Section(table, "frontend.disparity_offset")
      .add("prior_sigma_px", p.disparity_offset.prior_sigma_px, kNotNegative)
      .add("max_rate_px", p.disparity_offset.max_rate_px, kPositive)
      .add("window_frames", p.calibration_frames, {2, PointTrack::kCapacity - 1})
      .add("min_motion_m", p.disparity_offset.min_motion_m, kPositive)
      .add("min_points", p.disparity_offset.min_points, Range{7})
      .add("inlier_chi2", p.disparity_offset.inlier_chi2, kPositive)
      .add("huber_sigmas", p.disparity_offset.huber_sigmas, kPositive)
      .add("variance_inflation", p.disparity_offset.variance_inflation, Range{1});
  Section(table, "frontend.ego_motion")
      .add("max_hypotheses", p.ego_motion.max_hypotheses, {1, 10'000})
      .add("scored_points", p.ego_motion.scored_points, kAtLeastOne)
      .add("inlier_chi2", p.ego_motion.inlier_chi2, kPositive)
      .add("min_inliers", p.ego_motion.min_inliers, Range{3})
      .add("known_mover_weight", p.ego_motion.known_mover_weight, kShare)
      .add("vote_cell_m", p.ego_motion.vote_cell_m, kPositive)
      .add("vote_depth_m", p.ego_motion.vote_depth_m, kPositive)
      .add("max_acceleration_mps2", p.ego_motion.max_acceleration_mps2, kPositive)
      .add("surprise_penalty", p.ego_motion.surprise_penalty, kShare)
      .add("trusted_steady_frames", p.ego_motion.trusted_steady_frames, kAtLeastOne);
  addPoseFit(Section(table, "frontend.ego_motion.fit"), p.ego_motion.fit);
  Section(table, "frontend.scene_flow")
      .add("max_observations", p.scene_flow.max_observations, {2, PointTrack::kCapacity})
      .add("min_observations", p.scene_flow.min_observations, {2, PointTrack::kCapacity})
      .add("pose_jitter_px", p.scene_flow.pose_jitter_px, kNotNegative)
      .add("max_speed_mps", p.scene_flow.max_speed_mps, kPositive)
      .add("acceleration_mps2", p.scene_flow.acceleration_mps2, kNotNegative)
      .add("huber_sigmas", p.scene_flow.huber_sigmas, kPositive)
      .add("max_chi2_per_dof", p.scene_flow.max_chi2_per_dof, kPositive)
      .add("iterations", p.scene_flow.iterations, {1, 100});
}

void addGroundPlane(std::vector<Parameter>& table, GroundPlaneEstimator::Params& p) {
  Section(table, "frontend.ground_plane")
      .add("initial_height_m", p.initial_height_m, kPositive)
      .add("min_height_m", p.min_height_m, kPositive)
      .add("max_height_m", p.max_height_m, kPositive)
      .add("max_tilt_rad", p.max_tilt_rad, {0, 1.5})
      .add("max_depth_m", p.max_depth_m, kPositive)
      .add("max_side_m", p.max_side_m, kPositive)
      .add("inlier_m", p.inlier_m, kPositive)
      .add("hypotheses", p.hypotheses, {1, 10'000})
      .add("min_inliers", p.min_inliers, Range{3})
      .add("memory", p.memory, kShare);
}

void addSegmentation(std::vector<Parameter>& table, MotionSegmenter::Params& p) {
  Section(table, "frontend.segmentation")
      .add("max_flow_chi2", p.max_flow_chi2, kPositive)
      .add("speed_tolerance_mps", p.speed_tolerance_mps, kNotNegative)
      .add("max_turn_rate_radps", p.max_turn_rate_radps, kNotNegative)
      .add("max_gap_m", p.max_gap_m, kPositive)
      .add("max_speed_sigma_mps", p.max_speed_sigma_mps, kPositive)
      .add("epipolar_violation_sigmas", p.epipolar_violation_sigmas, kPositive)
      .add("flow_bound_violation_px", p.flow_bound_violation_px, kPositive)
      .add("min_points", p.min_points, Range{2})
      .add("min_speed_mps", p.min_speed_mps, kNotNegative)
      .add("min_significance", p.min_significance, kNotNegative)
      .add("systematic_speed_mps", p.systematic_speed_mps, kNotNegative)
      .add("systematic_angle_radps", p.systematic_angle_radps, kNotNegative)
      .add("systematic_disparity_pxps", p.systematic_disparity_pxps, kNotNegative)
      .add("certain_static_sigma_mps", p.certain_static_sigma_mps, kNotNegative)
      .add("max_extent_m", p.max_extent_m, kPositive)
      .add("max_height_m", p.max_height_m, kPositive)
      .add("max_vertical_ratio", p.max_vertical_ratio, kNotNegative);
}

void addTracking(std::vector<Parameter>& table, ObjectTracker::Params& p) {
  Section(table, "frontend.tracking")
      .add("confirm_sightings", p.confirm_sightings, kAtLeastOne)
      .add("confirm_speed_mps", p.confirm_speed_mps, kNotNegative)
      .add("confirm_significance", p.confirm_significance, kNotNegative)
      .add("confirm_travel_m", p.confirm_travel_m, kNotNegative)
      .add("confirm_extent_m", p.confirm_extent_m, kNotNegative)
      .add("confirm_extent_px", p.confirm_extent_px, kNotNegative)
      .add("look_back_frames", p.look_back_frames, {0, 50})
      .add("max_tentative_misses", p.max_tentative_misses, kAnyCount)
      .add("max_coasted_frames", p.max_coasted_frames, {0, 5})
      .add("max_lost_frames", p.max_lost_frames, kAnyCount)
      .add("max_presence_sigma_m", p.max_presence_sigma_m, kPositive)
      .add("max_lost_sigma_m", p.max_lost_sigma_m, kPositive)
      .add("reappearance_spread_m", p.reappearance_spread_m, kPositive)
      .add("stop_speed_mps", p.stop_speed_mps, kNotNegative)
      .add("start_speed_mps", p.start_speed_mps, kNotNegative)
      .add("stop_frames", p.stop_frames, kAtLeastOne)
      .add("image_margin_px", p.image_margin_px, kNotNegative)
      .add("twin_speed_mps", p.twin_speed_mps, kNotNegative)
      .add("twin_slack_m", p.twin_slack_m, kNotNegative)
      .add("birth_turn_rate_radps", p.birth_turn_rate_radps, kPositive);
  Section(table, "frontend.tracking.kinematics")
      .add("acceleration_along_mps2", p.kinematics.acceleration_along_mps2, kPositive)
      .add("acceleration_sideways_mps2", p.kinematics.acceleration_sideways_mps2, kPositive)
      .add("acceleration_vertical_mps2", p.kinematics.acceleration_vertical_mps2, kPositive)
      .add("acceleration_yaw_radps2", p.kinematics.acceleration_yaw_radps2, kPositive)
      .add("acceleration_tilt_radps2", p.kinematics.acceleration_tilt_radps2, kPositive)
      .add("slip_mps", p.kinematics.slip_mps, kPositive)
      .add("slip_per_mps", p.kinematics.slip_per_mps, kNotNegative)
      .add("vertical_mps", p.kinematics.vertical_mps, kPositive)
      .add("tilt_rate_radps", p.kinematics.tilt_rate_radps, kPositive)
      .add("tilt_rad", p.kinematics.tilt_rad, kPositive);
  Section(table, "frontend.tracking.association")
      .add("gate_chi2", p.association.gate_chi2, kPositive)
      .add("centroid_spread_m", p.association.centroid_spread_m, kPositive)
      .add("velocity_spread_mps", p.association.velocity_spread_mps, kPositive)
      .add("shared_points_bonus", p.association.shared_points_bonus, kNotNegative)
      .add("claimed_share", p.association.claimed_share, kShare);
}

void addObjects(std::vector<Parameter>& table, ObjectTracker::Params& p) {
  Section(table, "frontend.tracking.adoption")
      .add("margin_m", p.adoption.margin_m, kNotNegative)
      .add("depth_noise_sigmas", p.adoption.depth_noise_sigmas, kNotNegative)
      .add("max_length_m", p.adoption.max_length_m, kPositive)
      .add("vehicle_length_m", p.adoption.vehicle.length_m, kPositive)
      .add("vehicle_width_m", p.adoption.vehicle.width_m, kPositive)
      .add("vehicle_height_m", p.adoption.vehicle.height_m, kPositive)
      .add("fits_chi2", p.adoption.fits_chi2, kPositive)
      .add("not_static_chi2", p.adoption.not_static_chi2, kPositive)
      .add("min_speed_mps", p.adoption.min_speed_mps, kNotNegative);
  Section(table, "frontend.object_motion")
      .add("min_points", p.motion.min_points, kAtLeastOne)
      .add("inlier_chi2", p.motion.inlier_chi2, kPositive)
      .add("max_misfits", p.motion.max_misfits, kAnyCount)
      .add("split_points", p.motion.split_points, kAtLeastOne)
      .add("weak_position_m", p.motion.weak_position_m, kPositive)
      .add("weak_yaw_rad", p.motion.weak_yaw_rad, kPositive)
      .add("weak_tilt_rad", p.motion.weak_tilt_rad, kPositive)
      .add("presence_margin_m", p.motion.presence_margin_m, kNotNegative);
  addPoseFit(Section(table, "frontend.object_motion.fit"), p.motion.fit);
}

void addSmoother(std::vector<Parameter>& table, BackendParams& backend) {
  using Policy = Optimizer::RelinearizationPolicy;
  const std::vector<std::pair<std::string, RobustLoss>> losses{
      {"none", RobustLoss::kNone}, {"huber", RobustLoss::kHuber}, {"cauchy", RobustLoss::kCauchy}, {"tukey", RobustLoss::kTukey}};
  Optimizer::Params& p = backend.smoother;
  Section(table, "backend")
      .add("kind", backend.kind, {{"smoother", BackendKind::kSmoother}, {"filter", BackendKind::kFilter}})
      .add("window_frames", p.window_frames, kAnyCount)
      .add("relinearization", p.policy, {{"every", Policy::kEveryN}, {"fluid", Policy::kFluid}})
      .add("relinearize_every_updates", p.relinearize_every_updates, kAtLeastOne)
      .add("mismatch_tolerance", p.mismatch_tolerance, kNotNegative)
      .add("jacobian_drift_sigmas", p.jacobian_drift_sigmas, kNotNegative)
      .add("substitution_tolerance", p.substitution_tolerance, kNotNegative)
      .add("iterations_per_update", p.iterations_per_update, kAtLeastOne)
      .add("budget_scalars", p.budget_scalars, kNotNegative)
      .add("budget_ms", p.budget_ms, kNotNegative)
      .add("online_correction_s", p.online_correction_s, kNotNegative)
      .add("final_iterations", p.final_iterations, kAnyCount)
      .add("compute_covariances", p.compute_covariances)
      .add("camera_covariance_frames", p.camera_covariance_frames, kAtLeastOne)
      .add("covariance_lag_frames", p.covariance_lag_frames, kAnyCount);
  Section(table, "backend.factors")
      .add("use_motion", p.use_motion)
      .add("use_smoothness", p.use_smoothness)
      .add("use_camera_encounter", p.use_camera_encounter)
      .add("use_object_encounter", p.use_object_encounter)
      .add("encounter_loss", p.encounter_loss, losses)
      .add("encounter_loss_scale", p.encounter_loss_scale, kPositive)
      .add("motion_loss", p.motion_loss, losses)
      .add("motion_loss_scale", p.motion_loss_scale, kPositive)
      .add("odometry_variance_scale", p.odometry_variance_scale, kPositive)
      .add("encounter_variance_scale", p.encounter_variance_scale, kPositive)
      .add("motion_variance_scale", p.motion_variance_scale, kPositive)
      .add("object_correlation_s", p.object_correlation_s, kNotNegative)
      .add("first_pose_sigma_m", p.first_pose_sigma_m, kPositive)
      .add("first_pose_sigma_rad", p.first_pose_sigma_rad, kPositive)
      .add("object_origin_sigma_m", p.object_origin_sigma_m, kPositive)
      .add("object_origin_sigma_rad", p.object_origin_sigma_rad, kPositive)
      .add("anchor_sigma_m", p.anchor_sigma_m, kPositive)
      .add("anchor_sigma_rad", p.anchor_sigma_rad, kPositive)
      .add("acceleration_along_mps2", p.acceleration_along_mps2, kPositive)
      .add("acceleration_sideways_mps2", p.acceleration_sideways_mps2, kPositive)
      .add("acceleration_vertical_mps2", p.acceleration_vertical_mps2, kPositive)
      .add("acceleration_yaw_radps2", p.acceleration_yaw_radps2, kPositive)
      .add("acceleration_tilt_radps2", p.acceleration_tilt_radps2, kPositive)
      .add("object_encounter_share", p.object_encounter_share, kShare)
      .add("object_encounter_distance_m", p.object_encounter_distance_m, kPositive)
      .add("object_encounter_partners", p.object_encounter_partners, kAnyCount);
}

void addFilter(std::vector<Parameter>& table, FilterBackend::Params& p) {
  Section(table, "backend.filter")
      .add("acceleration_along_mps2", p.acceleration_along_mps2, kPositive)
      .add("acceleration_sideways_mps2", p.acceleration_sideways_mps2, kPositive)
      .add("acceleration_vertical_mps2", p.acceleration_vertical_mps2, kPositive)
      .add("acceleration_yaw_radps2", p.acceleration_yaw_radps2, kPositive)
      .add("acceleration_tilt_radps2", p.acceleration_tilt_radps2, kPositive)
      .add("initial_speed_sigma_mps", p.initial_speed_sigma_mps, kPositive)
      .add("initial_turn_rate_sigma_radps", p.initial_turn_rate_sigma_radps, kPositive)
      .add("adapt_process_noise", p.adapt_process_noise)
      .add("adaptation_time_s", p.adaptation_time_s, kPositive)
      .add("innovation_scale", p.innovation_scale, kPositive);
}

std::string numberText(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text;
}

std::string choicesText(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 < names.size() ? ", " : " or ";
    text += '"' + names[i] + '"';
  }
  return text;
}

}  // namespace

std::string Parameter::allowed() const {
  if (const auto* choice = std::get_if<Choice>(&value)) return choicesText(choice->names);
  if (std::holds_alternative<bool*>(value)) return "true or false";
  if (least == kPositive.least) return "above 0";
  if (std::isinf(most)) return "at least " + numberText(least);
  return numberText(least) + " to " + numberText(most);
}

std::vector<Parameter> parameterTable(PipelineConfig& config) {
  std::vector<Parameter> table;
  addPipeline(table, config.pipeline);
  addPreparation(table, config.preparation);
  addStereo(table, config.stereo);
  addOpticalFlow(table, config.optical_flow);
  addSceneMotion(table, config.scene_motion);
  addGroundPlane(table, config.scene_motion.ground_plane);
  addSegmentation(table, config.scene_motion.segmenter);
  addTracking(table, config.tracking);
  addObjects(table, config.tracking);
  addSmoother(table, config.backend);
  addFilter(table, config.backend.filter);
  return table;
}

}  // namespace motorcade
