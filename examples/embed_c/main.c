// Follows a recorded drive and prints each object's velocity with its covariance: embed_c DRIVE
#include <motorcade/motorcade.h>
#include <stdio.h>

int main(int argc, char** argv) {
  motorcade_recording* drive = NULL;
  motorcade_tracker* tracker = NULL;
  motorcade_result* result = NULL;
  motorcade_camera camera = {.struct_size = sizeof camera};
  motorcade_pair pair = {.struct_size = sizeof pair};
  motorcade_push push = {.struct_size = sizeof push};
  motorcade_frame frame = {.struct_size = sizeof frame};
  motorcade_object object = {.struct_size = sizeof object};
  const double *T = frame.T_world_cam, *v = object.velocity_world_mps, *c = object.velocity_covariance;  // row by row
  if (motorcade_recording_open(argc == 2 ? argv[1] : "", &drive) || motorcade_recording_camera(drive, &camera) ||
      motorcade_tracker_create(&camera, NULL, &tracker))
    return fprintf(stderr, "%s\n", motorcade_last_error()), 1;
  for (int64_t i = 0; motorcade_recording_read(drive, i, &pair) == MOTORCADE_OK; ++i) {
    if (motorcade_tracker_push(tracker, &pair, &push) || push.status == MOTORCADE_PUSH_REJECTED) continue;
    if (motorcade_tracker_wait(tracker, 5000, &result) || motorcade_result_frame(result, &frame)) continue;
    printf("%lld: camera at %.2f %.2f %.2f m\n", (long long)frame.frame, T[3], T[7], T[11]);
    for (size_t k = 0; k < frame.object_count && !motorcade_result_object(result, k, &object); ++k)
      printf("  object %lld: %.1f m ahead, velocity %.1f %.1f m/s, covariance %.3f %.3f %.3f\n", (long long)object.id,
             object.T_cam_body[11], v[0], v[2], c[0], c[2], c[8]);
    motorcade_result_release(result);
  }
  motorcade_tracker_destroy(tracker);
  motorcade_recording_close(drive);
}
