"""The Python package over a short rendered drive, whose folder is in MOTORCADE_DRIVE. The C++ example `embed`, with
which results are compared, is in MOTORCADE_EMBED. What the tracker itself does is tested in C++."""

import ast
import copy
import dataclasses
import gc
import multiprocessing
import os
import pathlib
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import time
import tracemalloc
import unittest
import warnings
import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from unittest import mock

import numpy as np

import motorcade
from motorcade import _motorcade

DRIVE = os.environ.get("MOTORCADE_DRIVE", "")
EMBED = os.environ.get("MOTORCADE_EMBED", "")
ROOT = pathlib.Path(__file__).resolve().parents[2]
PERIOD_NS = 100_000_000  # of a camera of 10 Hz
LONGEST_END_S = 1.0
CAMERA = motorcade.Camera(width_px=310, height_px=94, fx_px=180, fy_px=180, cx_px=155, cy_px=47, baseline_m=0.5)


def black() -> np.ndarray:
    return np.zeros((CAMERA.height_px, CAMERA.width_px), dtype=np.uint8)


def values_of(result: motorcade.Result) -> list[object]:
    """All that does not depend on time, so that two results can be compared bit by bit."""

    def flat(value: object) -> object:
        if isinstance(value, np.ndarray):
            return value.tobytes()
        if isinstance(value, (motorcade.Object, motorcade.Mask)):
            return [flat(getattr(value, name)) for name in value.__dataclass_fields__]
        if isinstance(value, tuple):
            return [flat(one) for one in value]
        return value

    return [flat(getattr(result, name)) for name in result.__dataclass_fields__ if name != "latency_ms"]


def follow(
    pairs: list[motorcade.Pair], camera: motorcade.Camera, push: dict[str, str] | None = None, **options: object
) -> list[list[object]]:
    with motorcade.Tracker(camera, policy="replay", **options) as tracker:
        for pair in pairs:
            answer = tracker.push(*pair, **(push or {}))
            assert answer.accepted, answer.why
        tracker.close()
        return [values_of(result) for result in tracker]


@contextmanager
def printed_exceptions() -> Iterator[list[str]]:
    """The messages of exceptions that nobody could catch."""
    messages: list[str] = []
    with mock.patch("sys.unraisablehook", lambda unraisable: messages.append(str(unraisable.exc_value))):
        yield messages


def until(condition: Callable[[], bool], longest_s: float = 10.0) -> bool:
    end = time.monotonic() + longest_s
    while not condition() and time.monotonic() < end:
        time.sleep(0.002)
    return condition()


def python(script: str, **options: object) -> "subprocess.Popen[str]":
    return subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                            **options)


class DescribingACamera(unittest.TestCase):
    def error(self, camera: object, **options: object) -> motorcade.Error:
        with self.assertRaises(motorcade.Error) as caught:
            motorcade.Tracker(camera, **options)
        return caught.exception

    def test_an_error_names_the_field_and_the_mend(self) -> None:
        error = self.error(motorcade.Camera(310, 94, 180, 180, 155, 47))
        self.assertEqual(error.field, "camera.baseline_m")
        self.assertTrue(str(error).startswith("camera.baseline_m: gives a baseline of 0.0 m; "), str(error))
        self.assertIsInstance(error, ValueError)
        self.assertEqual(self.error(motorcade.Camera(310, 94, 0, 180, 155, 47, 0.5)).field, "camera.fx_px")
        self.assertEqual(self.error(motorcade.Camera(31, 94, 180, 180, 15, 47, 0.5)).field, "camera.width_px")

    def test_ignored_pixels_have_the_shape_of_the_images(self) -> None:
        def camera(mask: object) -> motorcade.Camera:
            return dataclasses.replace(CAMERA, ignored=mask)

        for mask in (np.zeros((310, 94), np.uint8), np.zeros(310 * 94, np.uint8), np.zeros((93, 310), bool)):
            self.assertEqual(self.error(camera(mask)).field, "camera.ignored")
        for mask in (np.zeros((94, 310), np.uint8), np.ones((94, 310), bool)):
            motorcade.Tracker(camera(mask)).stop()
        with self.assertRaisesRegex(TypeError, "camera.ignored: is no array"):
            motorcade.Tracker(camera("bottom"))

    def test_errors_survive_pickling_and_copies(self) -> None:
        error = self.error(motorcade.Camera(310, 94, 180, 180, 155, 47))
        for other in (pickle.loads(pickle.dumps(error)), copy.copy(error)):
            self.assertEqual((other.field, str(other)), (error.field, str(error)))

    def test_values_of_another_type_are_named(self) -> None:
        with self.assertRaisesRegex(TypeError, "camera.width_px: is '310'; it is an integer"):
            motorcade.Tracker(motorcade.Camera("310", 94))
        with self.assertRaisesRegex(TypeError, "camera.fx_px: is None; it is a number"):
            motorcade.Tracker(motorcade.Camera(310, 94, None))
        with self.assertRaisesRegex(TypeError, "camera: is a dict without width_px"):
            motorcade.Tracker({})
        with self.assertRaisesRegex(TypeError, "options.threads: is 2.5; it is an integer"):
            motorcade.Tracker(CAMERA, threads=2.5)
        with self.assertRaisesRegex(TypeError, "options.cpus: is 'all'; it is a sequence of integers"):
            motorcade.Tracker(CAMERA, cpus="all")
        with self.assertRaisesRegex(TypeError, "options.cpus: is 3; it is a sequence of integers"):
            motorcade.Tracker(CAMERA, cpus=3)
        with self.assertRaisesRegex(TypeError, "a callback is a int, which cannot be called"):
            motorcade.Tracker(CAMERA, log=3)

    def test_options_out_of_range_are_named(self) -> None:
        for option, value in [("policy", "fast"), ("axes", "ned"), ("threads", 0), ("patience_s", -1.0),
                              ("settings", "frontend.points = 3"), ("cpus", [-1]), ("realtime_priority", 100),
                              ("covariance_frames", 61)]:
            self.assertEqual(self.error(CAMERA, **{option: value}).field, f"options.{option}")

    def test_a_rig_is_rectified_inside(self) -> None:
        lens = motorcade.Lens(180, 180, 155, 47, motorcade.Distortion.RADIAL_TANGENTIAL, [-0.1, 0.01])
        T_right_left = np.eye(4)
        T_right_left[0, 3] = -0.5
        for T in (T_right_left, T_right_left[:3], T_right_left.tolist()):
            rig = motorcade.Rig(lens, lens, T)
            with motorcade.Tracker(motorcade.Camera(310, 94, rig=rig), policy="replay") as tracker:
                self.assertTrue(tracker.push(black(), black(), 0).accepted)
                tracker.close()
                self.assertEqual(len(list(tracker)), 1)

    def test_an_error_in_a_rig_names_the_field(self) -> None:
        lens = motorcade.Lens(180, 180, 155, 47)
        cases = [
            ("camera.rig.left.fx_px", motorcade.Rig(motorcade.Lens(0, 180, 155, 47), lens, np.eye(4))),
            ("camera.rig.right.distortion", motorcade.Rig(lens, motorcade.Lens(180, 180, 155, 47, "fov"), np.eye(4))),
            ("camera.rig.left.coefficients",
             motorcade.Rig(motorcade.Lens(180, 180, 155, 47, "equidistant", [0.0] * 9), lens, np.eye(4))),
            ("camera.rig.T_right_left", motorcade.Rig(lens, lens, np.eye(4))),  # no baseline
            ("camera.rig.T_right_left", motorcade.Rig(lens, lens, np.eye(3))),
            ("camera.rig.T_right_left", motorcade.Rig(lens, lens, np.ones((4, 4)))),
        ]
        for field, rig in cases:
            self.assertEqual(self.error(motorcade.Camera(310, 94, rig=rig)).field, field)


class HandingImagesIn(unittest.TestCase):
    def setUp(self) -> None:
        self.tracker = motorcade.Tracker(CAMERA)
        self.addCleanup(self.tracker.stop)

    def test_pixels_of_another_type_are_refused_with_the_mend(self) -> None:
        for dtype in (np.float32, np.int8, np.bool_, np.dtype(">u2"), np.uint32):
            with self.assertRaisesRegex(TypeError, r"right: its pixels are .*image.astype\(numpy.uint8\)"):
                self.tracker.push(black(), black().astype(dtype), 1)

    def test_what_has_no_buffer_is_refused_with_the_mend(self) -> None:
        with self.assertRaisesRegex(TypeError, r"left: is a list, which has no buffer; .*numpy.asarray"):
            self.tracker.push([[0]], black(), 1)

    def test_shapes_that_are_no_images_are_refused(self) -> None:
        for shape in [(94,), (94, 310, 1), (94, 310, 4), (3, 94, 310), (1, 94, 310, 3)]:
            with self.assertRaisesRegex(ValueError, r"left: has the shape .*\(height, width, 3\)"):
                self.tracker.push(np.zeros(shape, np.uint8), black(), 1)
        with self.assertRaisesRegex(ValueError, "left: has the shape"):
            self.tracker.push(np.zeros((94, 310, 3), np.uint16), black(), 1)

    def test_columns_that_lie_apart_are_refused_with_the_mend(self) -> None:
        apart = [np.zeros((94, 620), np.uint8)[:, ::2], np.zeros((310, 94), np.uint8).T, black()[:, ::-1],
                 np.zeros((94, 310, 4), np.uint8)[:, :, :3], np.zeros((94, 310, 3), np.uint8)[:, :, ::-1]]
        for image in apart:
            with self.assertRaisesRegex(ValueError, r"left: the pixels of a row .*numpy.ascontiguousarray"):
                self.tracker.push(image, black(), 1)

    def test_rows_that_overlap_or_go_upwards_are_refused_with_the_mend(self) -> None:
        rows = [np.broadcast_to(black()[0], (94, 310)), black()[::-1],
                np.lib.stride_tricks.as_strided(black(), (94, 310), (1, 1))]
        for image in rows:
            with self.assertRaisesRegex(ValueError, r"left: its rows are .* bytes apart.*numpy.ascontiguousarray"):
                self.tracker.push(image, black(), 1)

    def test_an_unknown_order_of_colors_is_an_error(self) -> None:
        with self.assertRaises(motorcade.Error) as caught:
            self.tracker.push(black(), black(), 1, format="hsv")
        self.assertEqual(caught.exception.field, "format")

    def test_stamps_that_are_no_integers_are_refused(self) -> None:
        for stamp in (1.5, None, "1", 2**63):
            with self.assertRaisesRegex(TypeError, "stamp_ns: is .*; it is an integer of 64 bits"):
                self.tracker.push(black(), black(), stamp)
        self.assertTrue(self.tracker.push(black(), black(), np.int64(1)).accepted)

    def test_the_library_rejects_with_a_reason(self) -> None:
        def why(*pair: object) -> str:
            push = self.tracker.push(*pair)
            self.assertEqual((push.status, push.accepted), (motorcade.PushStatus.REJECTED, False))
            return push.why

        self.assertEqual(why(black()[:90], black(), 1), "an image is not of the camera's size")
        self.assertEqual(why(black(), None, 1), "an image has no pixels")
        self.assertTrue(self.tracker.push(black(), black(), 1000, 5).accepted)
        self.assertEqual(why(black(), black(), 1000), "its stamp does not follow that of the pair before")
        self.assertEqual(why(black(), black(), 2000, 5), "its number is not after that of the pair before")
        self.tracker.close()
        self.assertEqual(why(black(), black(), 3000), "the tracker was closed")
        self.assertEqual((self.tracker.counts.pushed, self.tracker.counts.rejected), (6, 5))
        self.tracker.stop()
        self.assertEqual(why(black(), black(), 4000), "the tracker was stopped")
        self.assertEqual(self.tracker.counts.pushed, 6)

    def test_the_vehicles_motion_is_taken_or_refused_with_a_reason(self) -> None:
        self.assertTrue(self.tracker.push_motion(5, 12.0, -0.1).accepted)
        self.assertTrue(self.tracker.push_motion(6, 12, 0, speed_sigma_mps=0.1).accepted)
        refused = self.tracker.push_motion(7, float("nan"), 0.0)
        self.assertFalse(refused.accepted)
        self.assertIn("speed", refused.why)
        with self.assertRaisesRegex(TypeError, "speed_mps: is 'fast'"):
            self.tracker.push_motion(8, "fast", 0.0)  # type: ignore[arg-type]
        self.assertEqual(self.tracker.counts.pushed, 0)

    def test_instance_labels_are_taken_or_refused_with_a_reason(self) -> None:
        def push(labels: object) -> motorcade.Push:
            self.stamp_ns = getattr(self, "stamp_ns", 0) + PERIOD_NS
            return self.tracker.push(black(), black(), self.stamp_ns, instances=labels)

        for labels in (None, black(), black().astype(np.uint16), memoryview(black()), np.zeros((94, 400), np.uint8)[:, :310]):
            self.assertTrue(push(labels).accepted)
        self.assertEqual(push(black()[:90]).why, "the instance labels are not of the camera's size")
        with self.assertRaisesRegex(TypeError, r"instances: its pixels are int32, .*labels.astype\(numpy.uint16\)"):
            push(black().astype(np.int32))
        with self.assertRaisesRegex(ValueError, r"instances: has the shape \(94, 310, 3\); labels are \(height, width\)"):
            push(np.zeros((94, 310, 3), np.uint8))
        self.assertEqual((self.tracker.counts.pushed, self.tracker.counts.rejected), (6, 1))

    def test_nothing_copies_the_pixels_on_the_way_to_the_library(self) -> None:
        # Numpy's and Python's allocations are traced, the library's own copy is not; an image has 29 kB.
        images = [black(), np.zeros((94, 400), np.uint8)[:, :310], np.zeros((94, 310), np.uint16),
                  np.zeros((94, 310, 3), np.uint8), memoryview(black())]
        for stamp, image in enumerate(images):
            tracemalloc.start()
            push = self.tracker.push(image, image, (1 + stamp) * PERIOD_NS)
            peak = tracemalloc.get_traced_memory()[1]
            tracemalloc.stop()
            self.assertTrue(push.accepted)
            self.assertLess(peak, 8000)

    def test_an_image_is_free_once_it_is_pushed(self) -> None:
        image = black()
        seen = weakref.ref(image)
        self.tracker.push(image, image, 1)
        del image
        self.assertIsNone(seen())


@unittest.skipUnless(DRIVE, "MOTORCADE_DRIVE names no drive")
class FollowingADrive(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.recording = motorcade.Recording(DRIVE)
        cls.camera = cls.recording.camera
        cls.pairs = list(cls.recording)
        cls.expected = follow(cls.pairs, cls.camera)

    def assert_same(self, given: list[list[object]], expected: list[list[object]]) -> None:
        """Bit by bit, without printing them."""
        self.assertEqual(len(given), len(expected))
        differing = [result[0] for result, other in zip(given, expected) if result != other]
        self.assertEqual(differing, [], "frames differ")

    def test_a_recording_is_a_sequence_of_pairs(self) -> None:
        self.assertEqual(len(self.recording), 14)
        pair = self.recording[-1]
        self.assertEqual((pair.frame, pair.left.dtype, pair.left.shape), (13, np.uint8, (94, 310)))
        np.testing.assert_array_equal(pair.right, self.pairs[13].right)
        self.assertGreater(np.ptp(pair.left), 100)
        self.assertEqual((self.camera.width_px, self.camera.height_px), (310, 94))
        self.assertEqual(self.camera.sigmas, motorcade.Sigmas(0, 0, 0, 0, 0))
        for index in (14, -15):
            with self.assertRaisesRegex(IndexError, "of 14"):
                self.recording[index]
        with self.assertRaises(motorcade.Error) as caught:
            motorcade.Recording(pathlib.Path(DRIVE) / "nowhere")
        self.assertEqual(caught.exception.field, "folder")

    def test_the_example_prints_what_the_one_in_cpp_prints(self) -> None:
        if not EMBED:
            self.skipTest("MOTORCADE_EMBED names no program")
        native = subprocess.run([EMBED, DRIVE], capture_output=True, text=True, check=True)
        script = ROOT / "examples" / "embed_python" / "embed.py"
        ours = subprocess.run([sys.executable, script, DRIVE], capture_output=True, text=True, check=True)
        self.assertRegex(ours.stdout, r"object \d+: .* covariance")
        self.assertEqual(ours.stdout.splitlines(), native.stdout.splitlines())
        self.assertEqual(ours.stderr, "")

    def test_a_result_has_the_shapes_and_types_it_promises(self) -> None:
        with motorcade.Tracker(self.camera, policy="replay", masks=True) as tracker:
            for pair in self.pairs:
                tracker.push(*pair)
            tracker.close()
            results = list(tracker)
        self.assertEqual([result.frame for result in results], list(range(14)))
        last = results[-1]
        self.assertIs(last.status, motorcade.Status.GOOD)
        self.assertIs(last.cause, motorcade.Cause.NONE)
        self.assertEqual(last.stamp_ns, self.pairs[-1].stamp_ns)
        self.assertEqual((last.T_world_cam.shape, last.velocity.shape), ((4, 4), (6,)))
        self.assertEqual((last.velocity_covariance.shape, last.motion_covariance.shape), ((6, 6), (6, 6)))
        self.assertIsNone(results[9].motion_covariance)
        self.assertEqual(results[9].pose_covariance.shape, (6, 6))
        self.assertGreater(last.latency_ms, 0)
        (thing,) = last.objects
        self.assertIs(thing.state, motorcade.State.MOVING)
        self.assertIsInstance(thing.kind, motorcade.Kind)
        self.assertGreaterEqual(thing.existence_probability, 0.5)
        self.assertLessEqual(thing.existence_probability, 1)
        self.assertLess(abs(thing.acceleration_mps2), 3 * thing.acceleration_sigma_mps2)
        self.assertLess(abs(thing.yaw_acceleration_radps2), 3 * thing.yaw_acceleration_sigma_radps2)
        shapes = {name: getattr(thing, name).shape for name in thing.__dataclass_fields__
                  if isinstance(getattr(thing, name), np.ndarray)}
        self.assertEqual(shapes, {
            "T_world_body": (4, 4), "T_cam_body": (4, 4), "covariance": (6, 6), "velocity_world_mps": (3,),
            "velocity_covariance": (3, 3), "image_box_px": (4,), "box_center_body_m": (3,), "box_size_m": (3,),
            "box_size_sigma_m": (3,), "box_center_sigma_m": (3,)})
        rounding = 1e-9
        np.testing.assert_allclose(thing.T_world_body, last.T_world_cam @ thing.T_cam_body, atol=rounding)
        np.testing.assert_array_equal(thing.T_world_body[3], [0, 0, 0, 1])
        np.testing.assert_allclose(thing.covariance, thing.covariance.T, atol=rounding)
        self.assertTrue((np.linalg.eigvalsh(thing.covariance) > 0).all())
        left, top, right, bottom = thing.image_box_px
        mask = thing.mask.image(94, 310)
        self.assertGreater(mask[int(top):int(bottom), int(left):int(right)].mean(), 0.5)
        self.assertLess(mask.mean(), 0.1)
        with self.assertRaises(AttributeError):
            last.frame = 3

    def test_run_gives_what_a_tracker_gives(self) -> None:
        run = motorcade.run(DRIVE)
        expected = iter(self.expected)
        fields = list(motorcade.Result.__dataclass_fields__)
        thing_fields = list(motorcade.Object.__dataclass_fields__)
        first = 0
        for index in range(len(run.frame)):
            frame = dict(zip([name for name in fields if name != "latency_ms"], next(expected)))
            for name in ("frame", "stamp_ns", "status", "cause", "segment"):
                self.assertEqual(getattr(run, name)[index], frame[name])
            for name in ("T_world_cam", "velocity", "velocity_covariance"):
                self.assertEqual(getattr(run, name)[index].tobytes(), frame[name])
            for name in ("pose_covariance", "motion_covariance"):
                self.assertEqual(np.isnan(getattr(run, name)[index]).all(), frame[name] is None)
            for members in frame["objects"]:
                thing = dict(zip(thing_fields, members))
                row = run.objects[first]
                first += 1
                self.assertEqual(row["frame"], frame["frame"])
                for name in motorcade.OBJECT_DTYPE.names[2:]:
                    if thing[name] is None:
                        self.assertTrue(np.isnan(row[name]).all(), name)
                        continue
                    same = row[name].tobytes() if isinstance(thing[name], bytes) else row[name]
                    self.assertEqual(same, thing[name], name)
        self.assertIsNone(next(expected, None))
        self.assertEqual(first, len(run.objects))
        self.assertGreater(first, 0)
        self.assertEqual((run.rejected, run.masks, run.counts.results), ({}, (), 14))

    def test_its_columns_make_a_table(self) -> None:
        run = motorcade.run(DRIVE, masks=True)
        columns = run.columns()
        self.assertEqual({column.shape for column in columns.values()}, {run.objects.shape})
        np.testing.assert_array_equal(columns["z_world_m"], run.objects["T_world_body"][:, 2, 3])
        np.testing.assert_array_equal(columns["vz_sigma_mps"], np.sqrt(run.objects["velocity_covariance"][:, 2, 2]))
        self.assertTrue((columns["kind"] == motorcade.Kind.CAR).any())
        self.assertTrue((columns["existence_probability"] >= 0.5).all())
        np.testing.assert_array_equal(columns["acceleration_mps2"], run.objects["acceleration_mps2"])
        self.assertTrue(np.isfinite(columns["yaw_acceleration_sigma_radps2"]).any())
        self.assertEqual(len(run.masks), len(run.objects))

    def test_run_follows_the_frames_it_is_asked_for(self) -> None:
        self.assertEqual(motorcade.run(DRIVE, 3).frame.tolist(), [0, 1, 2])
        self.assertEqual(motorcade.run(DRIVE, range(4, 10, 2)).frame.tolist(), [4, 6, 8])
        self.assertEqual(motorcade.run(DRIVE, 99).frame.tolist(), list(range(14)))
        none = motorcade.run(DRIVE, 0)
        self.assertEqual((none.T_world_cam.shape, none.objects.shape), ((0, 4, 4), (0,)))
        for frames in (-1, range(10, 20), range(5, 0, -1)):
            with self.assertRaises(motorcade.Error) as caught:
                motorcade.run(DRIVE, frames)
            self.assertEqual(caught.exception.field, "frames")

    def test_a_pair_that_cannot_be_read_is_rejected(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run(["cp", "-r", f"{DRIVE}/.", folder], check=True)
            damaged = sorted(pathlib.Path(folder, "image_1").glob("*.png"))[3]
            damaged.write_bytes(damaged.read_bytes()[:100])
            self.assertTrue(any(image is None for image in motorcade.Recording(folder)[3][:2]))
            self.assertEqual(motorcade.run(folder).rejected, {3: "an image has no pixels"})

    def test_axes_are_chosen_once(self) -> None:
        optical, rep103 = motorcade.run(DRIVE), motorcade.run(DRIVE, axes="rep103")
        rounding = 1e-9
        x, y, z = optical.T_world_cam[-1, :3, 3]
        np.testing.assert_allclose(rep103.T_world_cam[-1, :3, 3], [z, -x, -y], atol=rounding)

    def test_rows_may_lie_apart_and_arrays_may_be_read_only(self) -> None:
        def padded(image: np.ndarray) -> np.ndarray:
            wide = np.full((94, 401), 77, np.uint8)
            wide[:, 11:321] = image
            wide.flags.writeable = False
            return wide[:, 11:321]

        pairs = [pair._replace(left=padded(pair.left), right=memoryview(padded(pair.right))) for pair in self.pairs]
        self.assert_same(follow(pairs, self.camera), self.expected)

    def test_gray_of_16_bits_and_colors_give_what_gray_gives(self) -> None:
        def changed(change: Callable[[np.ndarray], np.ndarray]) -> list[motorcade.Pair]:
            return [pair._replace(left=change(pair.left), right=change(pair.right)) for pair in self.pairs]

        deep = changed(lambda image: (image.astype(np.uint16) << 8) + 5)
        self.assert_same(follow(deep, self.camera), self.expected)
        ten_bits = changed(lambda image: image.astype(np.uint16) * 4 + 3)
        self.assert_same(follow(ten_bits, self.camera), self.expected)
        self.assert_same(follow(changed(lambda image: np.dstack([image] * 3)), self.camera), self.expected)

    def test_the_order_of_colors_is_as_it_is_told(self) -> None:
        def changed(change: Callable[[np.ndarray], np.ndarray]) -> list[motorcade.Pair]:
            return [pair._replace(left=change(pair.left), right=change(pair.right)) for pair in self.pairs]

        def rgb(image: np.ndarray) -> np.ndarray:
            return np.dstack([image, image // 3, 255 - image])

        def gray(image: np.ndarray) -> np.ndarray:  # BT.601 in 256ths
            return ((rgb(image).astype(int) @ [77, 150, 29] + 128) >> 8).astype(np.uint8)

        expected = follow(changed(gray), self.camera)
        self.assert_same(follow(changed(rgb), self.camera), expected)
        bgr = changed(lambda image: np.ascontiguousarray(rgb(image)[:, :, ::-1]))
        self.assert_same(follow(bgr, self.camera, push={"format": "bgr"}), expected)

    def test_two_trackers_at_once_give_what_each_gives_alone(self) -> None:
        rep103 = follow(self.pairs, self.camera, axes="rep103")
        self.assertTrue(rep103 != self.expected)
        given: dict[str, list[list[object]]] = {}

        def work(axes: str) -> None:
            given[axes] = follow(self.pairs, self.camera, axes=axes)

        threads = [threading.Thread(target=work, args=(axes,)) for axes in ("optical", "rep103")]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assert_same(given["optical"], self.expected)
        self.assert_same(given["rep103"], rep103)


class TakingResults(unittest.TestCase):
    def tracker(self, **options: object) -> motorcade.Tracker:
        tracker = motorcade.Tracker(CAMERA, **{"policy": "replay", **options})
        self.addCleanup(tracker.stop)
        return tracker

    def push(self, tracker: motorcade.Tracker, count: int, first: int = 0) -> None:
        for index in range(first, first + count):
            self.assertTrue(tracker.push(black(), black(), (index + 1) * PERIOD_NS).accepted)

    def test_a_wait_ends_in_time_and_lets_other_threads_run(self) -> None:
        tracker = self.tracker()
        self.assertIsNone(tracker.poll())
        beats: list[float] = []
        over = threading.Event()

        def beat() -> None:
            while not over.wait(0.01):
                beats.append(time.monotonic())

        thread = threading.Thread(target=beat)
        thread.start()
        begin = time.monotonic()
        self.assertIsNone(tracker.wait(0.3))
        waited_s = time.monotonic() - begin
        over.set()
        thread.join()
        self.assertGreaterEqual(waited_s, 0.3)
        self.assertLess(waited_s, 0.3 + LONGEST_END_S)
        self.assertGreater(len(beats), 5)  # of 30
        self.assertFalse(tracker.done)
        self.assertIsNone(tracker.wait(-1))
        with self.assertRaisesRegex(ValueError, "timeout_s"):
            tracker.wait(float("nan"))

    def test_a_push_that_waits_for_room_lets_the_results_be_taken(self) -> None:
        tracker = self.tracker(patience_s=0.2)
        for index in range(256):
            self.assertTrue(tracker.push(black(), black(), (index + 1) * PERIOD_NS).accepted)
        push = tracker.push(black(), black(), 257 * PERIOD_NS)
        self.assertEqual(push.why, "256 results wait, and nobody takes them")
        later = threading.Timer(0.05, tracker.wait)
        later.start()
        self.assertTrue(tracker.push(black(), black(), 257 * PERIOD_NS).accepted)
        later.join()

    def test_live_the_newest_pair_wins_and_every_pair_is_accounted_for(self) -> None:
        tracker = self.tracker(policy="live")
        statuses = [tracker.push(black(), black(), (stamp + 1) * PERIOD_NS).status for stamp in range(200)]
        tracker.close()
        results = list(tracker)
        replaced = statuses.count(motorcade.PushStatus.REPLACED_OLDER)
        self.assertGreater(replaced, 0)
        self.assertEqual(set(statuses), {motorcade.PushStatus.ACCEPTED, motorcade.PushStatus.REPLACED_OLDER})
        self.assertEqual(sum(result.dropped_before for result in results), replaced)
        counts = tracker.counts
        self.assertEqual((counts.pushed, counts.rejected, counts.untaken), (200, 0, 0))
        self.assertEqual((counts.dropped, counts.results), (replaced, len(results)))
        self.assertEqual(len(results) + replaced, 200)

    def test_iteration_ends_with_the_last_result(self) -> None:
        tracker = self.tracker()
        self.push(tracker, 5)
        tracker.close()
        self.assertEqual([result.frame for result in tracker], [0, 1, 2, 3, 4])
        self.assertTrue(tracker.done)
        self.assertEqual(list(tracker), [])

    def test_a_callback_takes_the_results_until_it_is_taken_back(self) -> None:
        taken: list[int] = []
        tracker = self.tracker(on_result=lambda result: taken.append(result.frame))
        self.push(tracker, 5)
        self.assertTrue(until(lambda: taken == [0, 1, 2, 3, 4]), str(taken))
        self.assertIsNone(tracker.wait())
        with self.assertRaisesRegex(RuntimeError, "results go to on_result"):
            next(iter(tracker))
        tracker.on_result(None)
        self.push(tracker, 3, first=5)
        tracker.close()
        self.assertEqual([result.frame for result in tracker], [5, 6, 7])
        self.assertEqual(len(taken), 5)

    def test_finals_come_once_each_and_in_order_and_results_as_ever(self) -> None:
        finals: list[int] = []
        tracker = self.tracker()
        tracker.on_final(lambda final: finals.append(final.frame))
        self.push(tracker, 5)
        tracker.close()
        self.assertEqual([result.frame for result in tracker], [0, 1, 2, 3, 4])
        self.assertEqual(finals, [0, 1, 2, 3, 4])

    def test_a_tracker_that_was_reset_begins_anew(self) -> None:
        tracker = self.tracker()
        for _ in range(2):
            self.push(tracker, 3)
            tracker.close()
            self.assertEqual([result.frame for result in tracker], [0, 1, 2])
            tracker.reset()
            self.assertFalse(tracker.done)
        self.assertEqual(tracker.counts.results, 6)

    def test_a_callback_that_raises_is_printed_and_the_next_result_comes(self) -> None:
        calls: list[int] = []

        def take(result: motorcade.Result) -> None:
            calls.append(result.frame)
            raise KeyError(f"frame {result.frame}")

        with printed_exceptions() as printed:
            tracker = self.tracker(on_result=take)
            self.push(tracker, 3)
            tracker.close()
            self.assertTrue(until(lambda: tracker.done))
        self.assertEqual(calls, [0, 1, 2])
        self.assertEqual(printed, ["'frame 0'", "'frame 1'", "'frame 2'"])

    def test_a_callback_that_can_not_be_held_weakly_is_called(self) -> None:
        class Slotted:
            __slots__ = ("frames",)

            def __call__(self, result: motorcade.Result) -> None:
                self.frames.append(result.frame)

        take = Slotted()
        take.frames = []
        tracker = self.tracker(on_result=take)
        self.push(tracker, 2)
        self.assertTrue(until(lambda: take.frames == [0, 1]))

    def set_the_clock_back(self, tracker: motorcade.Tracker) -> None:
        """Which is logged when it is followed, after four pairs."""
        for stamp in (10**4, 10**4 + 1, *range(1, 8)):
            tracker.push(black(), black(), stamp * PERIOD_NS)
        tracker.close()

    def test_the_log_is_called_with_level_and_text(self) -> None:
        lines: list[tuple[motorcade.LogLevel, str]] = []
        tracker = self.tracker(log=lambda level, text: lines.append((level, text)))
        self.set_the_clock_back(tracker)
        self.assertGreater(len(list(tracker)), 2)
        self.assertEqual({level for level, _ in lines}, {motorcade.LogLevel.WARNING})
        self.assertIs(type(lines[0][0]), motorcade.LogLevel)
        self.assertIn("the clock of the camera was set back", "\n".join(text for _, text in lines))

    def test_a_log_that_raises_is_printed_and_results_come(self) -> None:
        def fail(level: motorcade.LogLevel, text: str) -> None:
            raise OSError("the disk is full")

        with printed_exceptions() as printed:
            tracker = self.tracker(log=fail)
            self.set_the_clock_back(tracker)
            self.assertGreater(len(list(tracker)), 2)
        self.assertIn("the disk is full", printed)


class Ending(unittest.TestCase):
    @contextmanager
    def soon(self) -> Iterator[None]:
        begin = time.monotonic()
        yield
        self.assertLess(time.monotonic() - begin, LONGEST_END_S)

    def test_in_mid_run(self) -> None:
        tracker = motorcade.Tracker(CAMERA, policy="replay")
        for index in range(50):
            tracker.push(black(), black(), (index + 1) * PERIOD_NS)
        with self.soon():
            del tracker

    def test_while_callbacks_want_the_interpreter(self) -> None:
        def busy(*_: object) -> None:
            end = time.monotonic() + 0.005
            while time.monotonic() < end:
                pass

        for _ in range(5):
            tracker = motorcade.Tracker(CAMERA, policy="replay", log=busy, on_result=busy)
            for index in range(20):
                tracker.push(black(), black(), (index + 1) * PERIOD_NS)
            with self.soon():
                del tracker

    def test_while_other_threads_wait(self) -> None:
        tracker = motorcade.Tracker(CAMERA, policy="replay", patience_s=60)
        returned: list[object] = []
        threads = [threading.Thread(target=lambda: returned.append(tracker.wait())) for _ in range(2)]
        for thread in threads:
            thread.start()
        time.sleep(0.1)
        with self.soon():
            tracker.stop()
            for thread in threads:
                thread.join()
        self.assertEqual(returned, [None, None])
        self.assertIsNone(tracker.poll())
        self.assertIsNone(tracker.wait())
        self.assertTrue(tracker.done)
        self.assertEqual(list(tracker), [])

    def test_while_a_push_waits_for_room(self) -> None:
        tracker = motorcade.Tracker(CAMERA, policy="replay", patience_s=60)
        pushes: list[motorcade.Push] = []

        def feed() -> None:
            for index in range(300):
                pushes.append(tracker.push(black(), black(), (index + 1) * PERIOD_NS))

        thread = threading.Thread(target=feed)
        thread.start()
        self.assertTrue(until(lambda: len(pushes) == 256))
        with self.soon():
            tracker.stop()
            thread.join()
        self.assertEqual({push.accepted for push in pushes[:256]}, {True})
        self.assertFalse(pushes[-1].accepted)

    def test_from_within_a_callback(self) -> None:
        stopped = threading.Event()

        def stop(result: motorcade.Result) -> None:
            tracker.stop()
            stopped.set()

        tracker = motorcade.Tracker(CAMERA, policy="replay", on_result=stop)
        tracker.push(black(), black(), 1)
        self.assertTrue(stopped.wait(10))
        self.assertTrue(tracker.done)
        with self.soon():
            _motorcade.wait_for_leaving()

    def test_when_a_callback_has_the_last_reference(self) -> None:
        holder: list[motorcade.Tracker] = []
        released = threading.Event()

        def take(result: motorcade.Result) -> None:
            holder.clear()
            gc.collect()  # in this thread of the tracker
            released.set()

        holder.append(motorcade.Tracker(CAMERA, policy="replay", on_result=take))
        gone = weakref.ref(holder[0])
        holder[0].push(black(), black(), 1)
        self.assertTrue(released.wait(10))
        self.assertTrue(until(lambda: gone() is None))
        with self.soon():
            _motorcade.wait_for_leaving()

    def test_a_cycle_through_a_callback_is_collected(self) -> None:
        class Node:
            def __init__(self) -> None:
                self.tracker = motorcade.Tracker(CAMERA, log=self.hear, on_result=self.take)

            def hear(self, level: motorcade.LogLevel, text: str) -> None:
                pass

            def take(self, result: motorcade.Result) -> None:
                pass

        node = weakref.ref(Node())
        gc.collect()
        self.assertIsNone(node())

    def test_with_the_block_of_a_context(self) -> None:
        with self.soon(), self.assertRaises(ZeroDivisionError):
            with motorcade.Tracker(CAMERA) as tracker:
                tracker.push(black(), black(), 1)
                raise ZeroDivisionError
        self.assertTrue(tracker.done)
        self.assertEqual(tracker.push(black(), black(), 2 * PERIOD_NS).why, "the tracker was stopped")

    def test_of_the_interpreter_with_a_tracker_at_work(self) -> None:
        script = """
import threading, numpy, motorcade
image = numpy.zeros((94, 310), numpy.uint8)
camera = motorcade.Camera(310, 94, 180, 180, 155, 47, 0.5)
tracker = motorcade.Tracker(camera, policy="replay", on_result=lambda result: sum(range(20000)), log=lambda *_: None)
other = motorcade.Tracker(camera)
def take():
    while not other.done:
        other.wait(1)
threading.Thread(target=take, daemon=True).start()
for stamp in range(40):
    tracker.push(image, image, stamp * 100_000_000)
"""
        for _ in range(5):
            child = python(script)
            out, error = child.communicate(timeout=30)
            self.assertEqual((child.returncode, out, error), (0, "", ""))

    def test_by_a_keyboard_interrupt_of_a_wait(self) -> None:
        child = python("import motorcade\n"
                       "camera = motorcade.Camera(310, 94, 180, 180, 155, 47, 0.5)\n"
                       "tracker = motorcade.Tracker(camera)\n"
                       "print('waits', flush=True)\n"
                       "tracker.wait()\n")
        self.assertEqual(child.stdout.readline(), "waits\n")
        time.sleep(0.1)
        child.send_signal(signal.SIGINT)
        with self.soon():
            _, error = child.communicate(timeout=30)
        self.assertIn("KeyboardInterrupt", error)

    def test_in_a_forked_process(self) -> None:
        tracker = motorcade.Tracker(CAMERA, policy="replay")
        tracker.push(black(), black(), 1)
        context = multiprocessing.get_context("fork")
        answers = context.Queue()

        def child() -> None:
            nonlocal tracker
            try:
                tracker.push(black(), black(), 2 * PERIOD_NS)
            except RuntimeError as error:
                answers.put(str(error))
            del tracker  # its threads are not here to be joined
            gc.collect()
            answers.put("gone")

        process = context.Process(target=child)
        process.start()
        self.assertIn("make a Tracker in each process", answers.get(timeout=10))
        self.assertEqual(answers.get(timeout=10), "gone")
        process.join(10)
        self.assertEqual(process.exitcode, 0)
        tracker.close()
        self.assertEqual(len(list(tracker)), 1)


class ThePackage(unittest.TestCase):
    def test_a_mask_is_spread_over_the_image_and_cut_at_its_borders(self) -> None:
        mask = motorcade.Mask(left_px=-1, top_px=2, cell_px=2, inside=np.array([[True, False], [False, True]]))
        np.testing.assert_array_equal(mask.image(5, 4), [
            [False, False, False, False],
            [False, False, False, False],
            [True, False, False, False],
            [True, False, False, False],
            [False, True, True, False]])

    def test_all_names_are_there_and_typed(self) -> None:
        for name in motorcade.__all__:
            self.assertTrue(hasattr(motorcade, name), name)
        folder = pathlib.Path(motorcade.__file__).parent
        self.assertTrue((folder / "py.typed").exists())
        self.assertRegex(motorcade.__version__, r"^\d+\.\d+\.\d+$")

    def test_the_stub_describes_the_extension(self) -> None:
        stub = ast.parse((pathlib.Path(motorcade.__file__).parent / "_motorcade.pyi").read_text())
        described = {node.name: {part.name for part in node.body} - {"__init__"} for node in stub.body
                     if isinstance(node, ast.ClassDef)}
        for name, members in described.items():
            there = {member for member in vars(getattr(_motorcade, name)) if not member.startswith("_")}
            self.assertEqual(members, there)
        functions = {node.name for node in stub.body if isinstance(node, ast.FunctionDef)}
        self.assertEqual(functions | set(described), {name for name in vars(_motorcade) if not name.startswith("_")})

    def test_the_example_plots_a_drive(self) -> None:
        if not DRIVE:
            self.skipTest("MOTORCADE_DRIVE names no drive")
        with tempfile.TemporaryDirectory() as folder:
            plot = pathlib.Path(folder) / "plot.png"
            script = ROOT / "python" / "examples" / "drive.py"
            done = subprocess.run([sys.executable, script, DRIVE, "--out", plot], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertIn("14 frames, 14 of them good, 1 objects", done.stdout)
            self.assertEqual(plot.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
            wrong = subprocess.run([sys.executable, script, folder, "--out", plot], capture_output=True, text=True)
            self.assertEqual(wrong.returncode, 1)
            self.assertIn("folder: ", wrong.stderr)
            self.assertNotIn("Traceback", wrong.stderr)


if __name__ == "__main__":
    warnings.simplefilter("error")
    unittest.main()
