"""The tracker."""

import atexit
import functools
import os
import weakref
from collections.abc import Callable, Iterator, Sequence
from types import TracebackType
from typing import Any, Literal, Self, TypeAlias

import numpy as np
import numpy.typing as npt

from motorcade import _motorcade
from motorcade._camera import Camera
from motorcade._results import Counts, LogLevel, Push, Result

Policy: TypeAlias = Literal["live", "replay"]
Axes: TypeAlias = Literal["optical", "rep103"]
Image: TypeAlias = npt.NDArray[np.uint8] | npt.NDArray[np.uint16] | memoryview | None
Log: TypeAlias = Callable[[LogLevel, str], object]


class Tracker:
    """Follows the camera and the objects around it.

    One thread pushes, one takes results; every other call is for any thread. Several trackers in one process share
    nothing but the processors. Raises ``Error``, whose ``field`` names what is to be mended.

    Leaving a ``with`` block, or the last reference, abandons what is in flight (``stop``); to have the results of all
    pairs, ``close`` and take them first.

    * ``policy``: ``"live"``, the newest pair wins and ``push`` never waits; ``"replay"``, no pair is lost, ``push``
      waits for room, and results do not depend on time or threads
    * ``axes`` of cam and world: ``"optical"``, x right, y down, z ahead, or ``"rep103"``, x ahead, y left, z up
    * ``masks``: objects come with the pixels that show them
    * ``threads``: 1 to 64; at most one per processor is used
    * ``realtime_priority`` of them: 1 to 99 is SCHED_FIFO, which may need a privilege
    * ``cpus`` that they may run on; empty: all
    * ``patience_s``: in replay, a ``push`` waits so long at most for results to be taken
    * ``covariance_frames`` that a result's ``motion_covariance`` reaches back: 1 to 60
    * ``settings``: lines of the program's configuration file: ``"frontend.optical_flow.max_tracks = 1000"``
    * ``log``: called with a level and a line, from the tracker's threads
    * ``on_result``: called with each ``Result`` on a thread of the tracker, in place of ``poll`` and ``wait``

    What a callback raises is printed (``sys.unraisablehook``), and the tracker goes on.
    """

    def __init__(
        self,
        camera: Camera,
        *,
        policy: Policy = "live",
        axes: Axes = "optical",
        masks: bool = False,
        threads: int = 2,
        realtime_priority: int = 0,
        cpus: Sequence[int] = (),
        patience_s: float = 5.0,
        covariance_frames: int = 10,
        settings: str = "",
        log: Log | None = None,
        on_result: Callable[[Result], object] | None = None,
    ) -> None:
        # The tracker's threads hold callbacks weakly, so that the garbage collector sees cycles through them. They are
        # kept here as long as a thread may be in one.
        self._callbacks: list[Callable[..., object]] = []
        self._native = _motorcade.Tracker(
            camera,
            self._kept(log),
            policy=policy,
            axes=axes,
            masks=masks,
            threads=threads,
            realtime_priority=realtime_priority,
            cpus=cpus,
            patience_s=patience_s,
            covariance_frames=covariance_frames,
            settings=settings,
        )
        _running.add(self)
        if on_result is not None:
            self.on_result(on_result)

    def push(
        self,
        left: Image,
        right: Image,
        stamp_ns: int,
        frame: int = -1,
        *,
        format: Literal["rgb", "bgr"] = "rgb",
        instances: Image = None,
    ) -> Push:
        """Hands one moment's two images in. They are numpy arrays, or anything else with the buffer protocol, of
        uint8 or uint16 (height x width) or of uint8 (height x width x 3; the order of colors is ``format``), of
        the camera's size, with any distance from row to row. The library copies them once, and nothing else does.
        Of uint16 the upper eight bits are used of the 8, 10, 12, 14 or 16 that hold the brightest sample of the first
        pair with one above 255; for all pairs, as the log tells.

        ``stamp_ns`` is the capture time, integer nanoseconds, after that of the pair before; ``frame`` its number,
        after that of the pair before, or -1 for the next one.

        ``instances`` are labels of the left image, rectified, where a network tells them: height x width, of uint8 or
        uint16, one number for the pixels of one body, 0 for none. They are evidence, and no more: they may be late,
        change from pair to pair, and be wrong.

        A pair or labels of another size than the camera's, a pair without pixels (None), not after the one before (a
        clock or numbers that were set back are followed after four pairs), after ``close``, or beside another thread's
        push is rejected, and the answer says why. Raises TypeError or ValueError for an array that is no image.
        """
        return self._native.push((left, right, instances), stamp_ns, frame, format)

    def push_motion(
        self,
        stamp_ns: int,
        speed_mps: float,
        yaw_rate_radps: float,
        speed_sigma_mps: float = 0.0,
        yaw_rate_sigma_radps: float = 0.0,
    ) -> Push:
        """What the vehicle's own sensors tell of its motion, that of the middle of its rear axle: positive ahead, and
        to the left. It predicts the camera where images fail. Samples come at a rate of their own, also late and out of
        order; a pair knows what came before it. ``stamp_ns`` is on the clock of the pairs. Standard deviations of 0 are
        found out.

        What contradicts the images is left out, as the log tells. Rejected is what is no number, and all after
        ``close``.
        """
        return self._native.push_motion(stamp_ns, speed_mps, yaw_rate_radps, speed_sigma_mps, yaw_rate_sigma_radps)

    def poll(self) -> Result | None:
        """The next result if there is one already."""
        return self._native.poll()

    def wait(self, timeout_s: float | None = None) -> Result | None:
        """Waits for the next result, for ever where ``timeout_s`` is None. None when there is none in time, and at
        once when there will be none (``done``) or results go to ``on_result``. Ctrl-C ends it."""
        return self._native.wait(timeout_s)

    def __iter__(self) -> Iterator[Result]:
        """The results, until there will be none: that is after ``close``."""
        while True:
            if self._native.hands_on():
                raise RuntimeError("results go to on_result; on_result(None) gives them to poll, wait and iteration")
            result = self._native.wait(None)
            if result is None:
                if self.done:
                    return
                continue
            yield result

    def on_result(self, take: Callable[[Result], object] | None) -> None:
        """From now on results go to ``take``, on a thread of the tracker, or where it is None to ``poll`` and ``wait``
        again. The callback before has returned by then, unless it is the caller."""
        self._native.on_result(self._kept(take))

    def on_final(self, take: Callable[[Result], object] | None) -> None:
        """From now on every frame, dropped ones too, goes to ``take`` once, in order, when it has left the smoothing
        window, the last ones after ``close``: as the program's final files have it, without velocity, masks and
        latency. ``done`` and the results that follow wait for ``take``, which may not call ``push`` and ``wait``."""
        self._native.on_final(self._kept(take))

    def close(self) -> None:
        """No further pair comes: the results of those that were accepted still do."""
        self._native.close()

    def reset(self) -> None:
        """Forgets the drive, and whatever is in flight or was not taken: the next pair begins a new world, with stamps
        and numbers of its own, also after ``close``. Ids and counts go on, and callbacks stay. Not for ``log`` and
        the callback for finals, which it waits for."""
        self._native.reset()

    def stop(self) -> None:
        """Abandons what is in flight and joins the tracker's threads, or from within a callback has that done behind
        the caller's back. Later calls do nothing: a ``push`` is rejected, and no result comes."""
        self._native.stop()

    @property
    def done(self) -> bool:
        """No result comes any more, and ``on_result`` has returned from the last one."""
        return self._native.done()

    @property
    def counts(self) -> Counts:
        return self._native.counts()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()

    def _kept(self, callback: Callable[..., Any] | None) -> Callable[..., Any] | None:
        if callback is None:
            return None
        if not callable(callback):
            raise TypeError(f"a callback is a {type(callback).__name__}, which cannot be called")
        held = functools.partial(callback)  # unlike some callables, it can be held weakly
        self._callbacks.append(held)
        return held


_running: "weakref.WeakSet[Tracker]" = weakref.WeakSet()


@atexit.register
def _stop_all() -> None:
    """No thread may ask for an interpreter that is gone."""
    for tracker in list(_running):
        tracker.stop()
    _motorcade.wait_for_leaving()


os.register_at_fork(after_in_child=_running.clear)
