"""A recorded drive, followed from its first pair to its last."""

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from motorcade._camera import Camera
from motorcade._error import Error
from motorcade._recording import Recording
from motorcade._results import Array, Cause, Counts, Kind, Mask, Object, Result, State, Status
from motorcade._tracker import Axes, Log, Policy, Tracker


def _text(values: type[Status] | type[Cause] | type[State] | type[Kind]) -> str:
    return f"U{max(len(value) for value in values)}"


OBJECT_DTYPE = np.dtype(
    [
        ("frame", "i8"),
        ("stamp_ns", "i8"),
        ("id", "i8"),
        ("state", _text(State)),
        ("kind", _text(Kind)),
        ("kind_probability", "f8"),
        ("existence_probability", "f8"),
        ("T_world_body", "f8", (4, 4)),
        ("T_cam_body", "f8", (4, 4)),
        ("covariance", "f8", (6, 6)),
        ("velocity_world_mps", "f8", (3,)),
        ("velocity_covariance", "f8", (3, 3)),
        ("yaw_rate_radps", "f8"),
        ("yaw_rate_sigma_radps", "f8"),
        ("acceleration_mps2", "f8"),
        ("acceleration_sigma_mps2", "f8"),
        ("yaw_acceleration_radps2", "f8"),
        ("yaw_acceleration_sigma_radps2", "f8"),
        ("age_s", "f8"),
        ("points", "i8"),
        ("image_box_px", "f8", (4,)),
        ("box_center_body_m", "f8", (3,)),
        ("box_size_m", "f8", (3,)),
        ("box_size_sigma_m", "f8", (3,)),
        ("box_center_sigma_m", "f8", (3,)),
    ]
)
"""One row of ``Run.objects``: one object in one frame, with the members of ``Object``."""


@dataclass(frozen=True, eq=False)
class Run:
    """What is known of a drive: arrays with one row for each of n frames, and ``objects`` with one for each object in
    each frame. Covariances and accelerations are NaN where there are none. ``status``, ``cause``, ``state`` and ``kind`` are text, as the
    enumerations of their names: ``run.status == motorcade.Status.GOOD``.
    """

    camera: Camera
    """Rectified."""
    frame: npt.NDArray[np.int64]
    """n: the pair's index in the recording."""
    stamp_ns: npt.NDArray[np.int64]
    """n: capture time."""
    status: npt.NDArray[np.str_]
    """n."""
    cause: npt.NDArray[np.str_]
    """n."""
    segment: npt.NDArray[np.int64]
    """n."""
    T_world_cam: Array
    """n x 4 x 4."""
    pose_covariance: Array
    """n x 6 x 6."""
    motion_covariance: Array
    """n x 6 x 6."""
    velocity: Array
    """n x 6: velocity [m/s] and turn rate [rad/s] in the camera's axes."""
    velocity_covariance: Array
    """n x 6 x 6."""
    latency_ms: Array
    """n."""
    objects: npt.NDArray[np.void]
    """Of ``OBJECT_DTYPE``, by frame and id."""
    masks: tuple[Mask | None, ...]
    """Of ``objects``, with ``masks=True``; else empty."""
    rejected: dict[int, str]
    """Pairs that were rejected, by their index, and why."""
    counts: Counts

    def columns(self) -> dict[str, npt.NDArray[Any]]:
        """``objects`` as a table of plain columns: ``pandas.DataFrame(run.columns())``. Sigmas of the velocity are
        those along its axes."""
        table: dict[str, npt.NDArray[Any]] = {}
        for name in ("frame", "stamp_ns", "id", "state", "kind", "kind_probability"):
            table[name] = self.objects[name]
        for name in ("existence_probability", "age_s", "points"):
            table[name] = self.objects[name]
        sigma_mps = np.sqrt(np.diagonal(self.objects["velocity_covariance"], axis1=1, axis2=2))
        for axis, letter in enumerate("xyz"):
            table[f"{letter}_world_m"] = self.objects["T_world_body"][:, axis, 3]
            table[f"{letter}_cam_m"] = self.objects["T_cam_body"][:, axis, 3]
            table[f"v{letter}_world_mps"] = self.objects["velocity_world_mps"][:, axis]
            table[f"v{letter}_sigma_mps"] = sigma_mps[:, axis]
        for name in ("yaw_rate_radps", "yaw_rate_sigma_radps", "acceleration_mps2", "acceleration_sigma_mps2"):
            table[name] = self.objects[name]
        for name in ("yaw_acceleration_radps2", "yaw_acceleration_sigma_radps2"):
            table[name] = self.objects[name]
        for side, name in enumerate(("left_px", "top_px", "right_px", "bottom_px")):
            table[name] = self.objects["image_box_px"][:, side]
        for axis, name in enumerate(("length", "width", "height")):
            table[f"{name}_m"] = self.objects["box_size_m"][:, axis]
            table[f"{name}_sigma_m"] = self.objects["box_size_sigma_m"][:, axis]
        return {name: np.ascontiguousarray(column) for name, column in table.items()}


def run(
    folder: str | os.PathLike[str],
    frames: int | range | None = None,
    *,
    policy: Policy = "replay",
    axes: Axes = "optical",
    masks: bool = False,
    threads: int = 2,
    realtime_priority: int = 0,
    cpus: Sequence[int] = (),
    patience_s: float = 5.0,
    covariance_frames: int = 10,
    settings: str = "",
    log: Log | None = None,
) -> Run:
    """Follows a recorded drive and gives what is known of it as arrays.

    ``frames`` are its first ones, or those of a range that counts up, or all. The options are the tracker's; with
    ``policy="live"`` pairs are handed in as fast as they are read, and most are dropped. Raises ``Error``.
    """
    recording = Recording(folder)
    tracker = Tracker(
        recording.camera,
        policy=policy,
        axes=axes,
        masks=masks,
        threads=threads,
        realtime_priority=realtime_priority,
        cpus=cpus,
        patience_s=patience_s,
        covariance_frames=covariance_frames,
        settings=settings,
        log=log,
    )
    rejected: dict[int, str] = {}
    with tracker:
        results = list(_follow(recording, _chosen(frames, len(recording)), tracker, rejected))
        counts = tracker.counts
    return _arrays(recording.camera, results, masks, rejected, counts)


def _chosen(frames: int | range | None, size: int) -> range:
    """The indices of the pairs to read."""
    if frames is None:
        return range(size)
    if isinstance(frames, range):
        if frames.step < 1 or (len(frames) > 0 and not 0 <= frames[0] <= frames[-1] < size):
            raise Error("frames", f"is {frames}; it counts up, within the {size} pairs of the drive")
        return frames
    if frames < 0:
        raise Error("frames", f"is {frames}; it is how many of the {size} pairs are read, or a range of them")
    return range(min(frames, size))


def _follow(recording: Recording, indices: range, tracker: Tracker, rejected: dict[int, str]) -> Iterator[Result]:
    for index in indices:
        push = tracker.push(*recording[index])
        if not push.accepted:
            rejected[index] = push.why
        while (result := tracker.poll()) is not None:
            yield result
    tracker.close()
    yield from tracker


def _stacked(matrices: Sequence[Array | None], *shape: int) -> Array:
    stacked = np.full((len(matrices), *shape), np.nan)
    for row, matrix in zip(stacked, matrices):
        if matrix is not None:
            row[...] = matrix
    return stacked


def _integers(values: Sequence[int]) -> npt.NDArray[np.int64]:
    return np.array(values, dtype=np.int64)


def _row(result: Result, thing: Object) -> tuple[Any, ...]:
    """Of ``OBJECT_DTYPE``."""
    members = [result.frame, result.stamp_ns]
    members += [getattr(thing, name) for name in OBJECT_DTYPE.names[2:]]  # type: ignore[index]
    return tuple(np.nan if member is None else member for member in members)


def _arrays(
    camera: Camera, results: Sequence[Result], masks: bool, rejected: dict[int, str], counts: Counts
) -> Run:
    return Run(
        camera=camera,
        frame=_integers([result.frame for result in results]),
        stamp_ns=_integers([result.stamp_ns for result in results]),
        status=np.array([result.status.value for result in results], dtype=_text(Status)),
        cause=np.array([result.cause.value for result in results], dtype=_text(Cause)),
        segment=_integers([result.segment for result in results]),
        T_world_cam=_stacked([result.T_world_cam for result in results], 4, 4),
        pose_covariance=_stacked([result.pose_covariance for result in results], 6, 6),
        motion_covariance=_stacked([result.motion_covariance for result in results], 6, 6),
        velocity=_stacked([result.velocity for result in results], 6),
        velocity_covariance=_stacked([result.velocity_covariance for result in results], 6, 6),
        latency_ms=np.array([result.latency_ms for result in results], dtype=np.float64),
        objects=np.array([_row(result, thing) for result in results for thing in result.objects], dtype=OBJECT_DTYPE),
        masks=tuple(thing.mask for result in results for thing in result.objects) if masks else (),
        rejected=rejected,
        counts=counts,
    )
