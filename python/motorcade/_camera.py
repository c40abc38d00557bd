"""The stereo camera, as it is described to a tracker."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

Matrix: TypeAlias = npt.NDArray[np.float64] | Sequence[Sequence[float]]
Mask: TypeAlias = npt.NDArray[np.uint8] | npt.NDArray[np.bool_]


class Distortion(StrEnum):
    """The model of a lens's distortion."""

    NONE = "none"
    RADIAL_TANGENTIAL = "radial_tangential"
    EQUIDISTANT = "equidistant"


@dataclass(frozen=True, eq=False)
class Lens:
    """One lens of a pair that is still to be rectified, in pixels of the images that are pushed.

    ``coefficients``, at most eight, are k1 k2 p1 p2 k3 k4 k5 k6 as OpenCV orders them; equidistant: k1 k2 k3 k4.
    """

    fx_px: float
    fy_px: float
    cx_px: float
    cy_px: float
    distortion: Distortion | str = Distortion.NONE
    coefficients: Sequence[float] = ()


@dataclass(frozen=True, eq=False)
class Rig:
    """Two lenses and how they are mounted; the tracker rectifies their images.

    ``T_right_left``, 3x4 or 4x4, takes coordinates [m] in the left lens's frame to the right one's: x right, y down,
    z ahead.
    """

    left: Lens
    right: Lens
    T_right_left: Matrix


@dataclass(frozen=True)
class Sigmas:
    """How exact a calibration is: standard deviations of errors that stay the same. Zeros: it is exact."""

    focal: float = 0.002
    """Of the focal length of both cameras, as a share."""
    middle_px: float = 0.7
    """Of the principal point of both, each way."""
    distortion: float = 0.01
    """Of the radial term k1 of both; of the tangential ones a tenth."""
    baseline: float = 0.001
    """As a share."""
    disparity_px: float = 0.15
    """In the middle of the image, as the right camera is turned."""


@dataclass(frozen=True, eq=False)
class Camera:
    """The stereo camera: of a rectified pair, or with ``rig`` of one that is rectified inside.

    ``width_px`` and ``height_px`` are those of the images that are pushed. The intrinsics [px] and ``baseline_m`` are
    the rectified pair's; with a rig they are not read. ``ignored`` has a row and a column for each pixel of the left
    image, rectified; those that are not 0 are of no use. A hood is found without it. Covariances of poses, motions and
    objects' velocities include the effect of calibration errors as large as ``sigmas`` say, or else the settings, or
    else typical ones.
    """

    width_px: int
    height_px: int
    fx_px: float = 0.0
    fy_px: float = 0.0
    cx_px: float = 0.0
    cy_px: float = 0.0
    baseline_m: float = 0.0
    rig: Rig | None = None
    ignored: Mask | None = None
    sigmas: Sigmas | None = None
