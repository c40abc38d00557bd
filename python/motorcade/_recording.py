"""Recorded drives."""

import os
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from motorcade import _motorcade
from motorcade._camera import Camera


class Pair(NamedTuple):
    """One moment's two images, in the order of ``Tracker.push``: ``tracker.push(*pair)``."""

    left: npt.NDArray[np.uint8] | None
    """Height x width; None where the file cannot be read, and the tracker will reject the pair."""
    right: npt.NDArray[np.uint8] | None
    stamp_ns: int
    frame: int


class Recording:
    """A recorded drive: a folder of KITTI, EuRoC, Argoverse or plain images (docs/formats.md).

    Raises ``Error`` where there is none. Pairs are read when they are asked for, rectified; each owns its images.
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self._native = _motorcade.Recording(os.fsencode(folder))

    @property
    def camera(self) -> Camera:
        """Rectified, as the pairs are."""
        return self._native.camera()

    def __len__(self) -> int:
        return self._native.size()

    def __getitem__(self, index: int) -> Pair:
        """The pair of that index; negative ones count from the end."""
        size = len(self)
        if not -size <= index < size:
            raise IndexError(f"pair {index} of {size}")
        return self._native.read(index % size)

    def __iter__(self) -> Iterator[Pair]:
        for index in range(len(self)):
            yield self[index]
