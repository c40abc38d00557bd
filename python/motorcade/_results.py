"""What a tracker gives. Arrays are numpy's, of float64 where nothing else is said, and belong to whoever holds them.

``T_a_b`` is a 4x4 matrix that takes coordinates in b to coordinates in a, and neighbors cancel:
``T_world_body = T_world_cam @ T_cam_body``. Frames:

* cam: the left camera, rectified; x right, y down, z ahead, or with ``axes="rep103"`` x ahead, y left, z up
* world: the first frame's cam
* body: of an object, fixed to it; x in the direction of travel, y left, z up, with either axes

Covariances of poses, 6x6, are of perturbations (rho, phi) [m, rad] on the right, T exp(rho, phi). On real drives they
are too small: keep a margin.
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

Array: TypeAlias = npt.NDArray[np.float64]


class Status(StrEnum):
    """How a frame went; where it is lost or rejected, the camera's pose is predicted, with a wide covariance."""

    GOOD = "good"
    LOST = "lost"
    REJECTED = "rejected"


class Cause(StrEnum):
    """Why a frame is not simply good; good with a cause: measured, but less surely."""

    NONE = "none"
    AFTER_GAP = "after_gap"
    FEW_POINTS = "few_points"
    NO_POINTS = "no_points"
    UNLINKED = "unlinked"
    FAILED = "failed"
    UNUSABLE = "unusable"
    OUT_OF_ORDER = "out_of_order"
    TOO_LATE = "too_late"


class State(StrEnum):
    """What an object does; predicted: it was not seen in this frame."""

    MOVING = "moving"
    STOPPED = "stopped"
    PREDICTED = "predicted"


class Kind(StrEnum):
    """What an object is."""

    UNKNOWN = "unknown"
    CAR = "car"
    LARGE_VEHICLE = "large_vehicle"
    TWO_WHEELER = "two_wheeler"
    PEDESTRIAN = "pedestrian"


class PushStatus(StrEnum):
    """What became of a pair; replaced: it was accepted, and an older one that still waited was dropped."""

    ACCEPTED = "accepted"
    REPLACED_OLDER = "replaced_older"
    REJECTED = "rejected"


class LogLevel(StrEnum):
    """How grave a line of the log is."""

    INFO = "info"
    WARNING = "warning"
    ERROR = "error"


@dataclass(frozen=True, eq=False, slots=True)
class Mask:
    """The left image's pixels that show an object, in cells of ``cell_px`` pixels each way.

    ``inside``, bool, is rows x columns of cells, the first at (``left_px``, ``top_px``).
    """

    left_px: int
    top_px: int
    cell_px: int
    inside: npt.NDArray[np.bool_]

    def image(self, height_px: int, width_px: int) -> npt.NDArray[np.bool_]:
        """The mask pixel by pixel, height x width, for an image of that size."""
        whole = np.zeros((height_px, width_px), dtype=np.bool_)
        pixels = self.inside.repeat(self.cell_px, axis=0).repeat(self.cell_px, axis=1)
        rows = np.arange(pixels.shape[0]) + self.top_px
        columns = np.arange(pixels.shape[1]) + self.left_px
        seen_rows = (rows >= 0) & (rows < height_px)
        seen_columns = (columns >= 0) & (columns < width_px)
        whole[np.ix_(rows[seen_rows], columns[seen_columns])] = pixels[np.ix_(seen_rows, seen_columns)]
        return whole


@dataclass(frozen=True, eq=False, slots=True)
class Object:
    """A moving object, or one that has moved, in one frame."""

    id: int
    """Never used twice by one tracker."""
    state: State
    T_world_body: Array
    """4x4."""
    T_cam_body: Array
    """4x4."""
    covariance: Array | None
    """6x6, of ``T_cam_body``."""
    velocity_world_mps: Array
    """3, of the body's origin, over ground."""
    velocity_covariance: Array
    """3x3 [m^2/s^2], the camera's own drift left out."""
    yaw_rate_radps: float
    """About the body's z axis."""
    yaw_rate_sigma_radps: float
    acceleration_mps2: float | None
    """Along its path: positive where it becomes faster. None in its first frame."""
    acceleration_sigma_mps2: float | None
    yaw_acceleration_radps2: float | None
    """About the body's z axis; None as above."""
    yaw_acceleration_sigma_radps2: float | None
    age_s: float
    """Since it was first reported."""
    points: int
    """Seen on it in this frame."""
    image_box_px: Array
    """4: left, top, right, bottom in the left image, inclusive."""
    box_center_body_m: Array
    """3, of the cuboid along the body's axes, its bottom on the ground."""
    box_size_m: Array
    """3: length, width, height; length 0 where it is not known yet."""
    box_size_sigma_m: Array
    """3."""
    box_center_sigma_m: Array
    """3, along the body's axes."""
    kind: Kind
    kind_probability: float
    existence_probability: float
    """That it is there and moves, or moved before."""
    mask: Mask | None
    """With ``masks=True``, where the outline was found."""


@dataclass(frozen=True, eq=False, slots=True)
class Result:
    """What is known in one frame, as soon as it is."""

    frame: int
    stamp_ns: int
    status: Status
    cause: Cause
    segment: int
    """Counts up where nothing measured links the poses before and after."""
    T_world_cam: Array
    """4x4."""
    pose_covariance: Array | None
    """6x6, of ``T_world_cam``, relative to the frame that defines the world: grows with the way. None behind a gap."""
    motion_covariance: Array | None
    """6x6, of the camera's motion T_cam(before)_cam(now), ``covariance_frames`` apart."""
    velocity: Array
    """6: the camera's own motion since the frame before, in its axes: velocity [m/s] and turn rate [rad/s]."""
    velocity_covariance: Array
    """6x6."""
    objects: tuple[Object, ...]
    """By id."""
    dropped_before: int
    """Pairs since the result before that a newer one replaced."""
    latency_ms: float
    """From ``push`` to the result."""
    problem: str
    """Why the pair was lost or rejected, in a sentence."""


@dataclass(frozen=True, slots=True)
class Push:
    """What became of a pair, and why where it was rejected."""

    status: PushStatus
    why: str = ""

    @property
    def accepted(self) -> bool:
        return self.status != PushStatus.REJECTED


@dataclass(frozen=True, slots=True)
class Counts:
    """Of a tracker's pairs and results so far."""

    pushed: int
    rejected: int
    """By ``push``; no result comes of a rejected pair."""
    dropped: int
    """Replaced by a newer one."""
    results: int
    untaken: int
    """Lost since nobody took them (live: beyond 256)."""
