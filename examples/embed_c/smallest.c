// The smallest program with a camera of its own: it shows a gray wall. Replace `capture` by your driver's call.
#include <motorcade/motorcade.h>
#include <stdio.h>
#include <string.h>

enum { WIDTH = 640, HEIGHT = 360 };
static uint8_t left_pixels[WIDTH * HEIGHT], right_pixels[WIDTH * HEIGHT];

static bool capture(int64_t* stamp_ns) {  // false: the camera was switched off
  static int64_t captured = 0;
  memset(left_pixels, 128, sizeof left_pixels);
  memset(right_pixels, 128, sizeof right_pixels);
  *stamp_ns = 100000000 * captured;
  return captured++ < 20;
}

static void use(motorcade_result* result) {
  motorcade_frame frame = {.struct_size = sizeof frame};
  motorcade_object object = {.struct_size = sizeof object};
  if (motorcade_result_frame(result, &frame) == MOTORCADE_OK)
    printf("frame %lld, status %d, cause %d\n", (long long)frame.frame, (int)frame.status, (int)frame.cause);
  for (size_t i = 0; i < frame.object_count; ++i)
    if (motorcade_result_object(result, i, &object) == MOTORCADE_OK) printf("  object %lld\n", (long long)object.id);
  motorcade_result_release(result);
}

int main(void) {
  motorcade_camera camera = {.struct_size = sizeof camera,
                             .width_px = WIDTH,
                             .height_px = HEIGHT,
                             .fx_px = 400,
                             .fy_px = 400,
                             .cx_px = 320,
                             .cy_px = 180,
                             .baseline_m = 0.5};
  motorcade_tracker* tracker = NULL;
  if (motorcade_tracker_create(&camera, NULL, &tracker))  // NULL: default options, so the newest pair wins
    return fprintf(stderr, "%s: %s\n", motorcade_last_error_field(), motorcade_last_error()), 1;

  motorcade_image left = {.struct_size = sizeof left, .width_px = WIDTH, .height_px = HEIGHT, .pixels = left_pixels};
  motorcade_image right = {.struct_size = sizeof right, .width_px = WIDTH, .height_px = HEIGHT, .pixels = right_pixels};
  motorcade_pair pair = {.struct_size = sizeof pair};
  motorcade_pair_init(&pair);  // frame -1: pairs are numbered as they come
  pair.left = &left, pair.right = &right;
  motorcade_push push = {.struct_size = sizeof push};
  motorcade_result* result = NULL;
  while (capture(&pair.stamp_ns)) {
    if (motorcade_tracker_push(tracker, &pair, &push))
      fprintf(stderr, "%s\n", motorcade_last_error());
    else if (push.status == MOTORCADE_PUSH_REJECTED)
      fprintf(stderr, "rejected: %s\n", push.why);  // go on with the next
    while (motorcade_tracker_poll(tracker, &result) == MOTORCADE_OK) use(result);
  }
  motorcade_tracker_close(tracker);
  motorcade_code code;
  while ((code = motorcade_tracker_wait(tracker, 1000, &result)) != MOTORCADE_DONE && code >= 0)
    if (code == MOTORCADE_OK) use(result);  // MOTORCADE_NONE: none within a second
  motorcade_tracker_destroy(tracker);
}
