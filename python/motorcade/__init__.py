"""Motorcade: follows a car's own path and the moving vehicles around it from one stereo camera.

A recorded drive, whole, as arrays::

    drive = motorcade.run("data/kitti_tracking_0003")
    drive.T_world_cam[:, :3, 3]                         # the camera's path [m]
    drive.objects[drive.objects["id"] == 3]["velocity_world_mps"]

Images as they come, in one thread, and results in another or by a callback::

    with motorcade.Tracker(camera, log=print) as tracker:
        tracker.push(left, right, stamp_ns)             # numpy arrays, copied once
        result = tracker.wait(timeout_s=0.1)

Names carry their units: meters, seconds, radians, pixels, integer nanoseconds. Frames and matrices are described at
``Result`` (module ``motorcade._results``), and each member at itself.
"""

from motorcade import _motorcade
from motorcade._camera import Camera, Distortion, Lens, Rig, Sigmas
from motorcade._error import Error
from motorcade._recording import Pair, Recording
from motorcade._results import Cause, Counts, Kind, LogLevel, Mask, Object, Push, PushStatus, Result, State, Status
from motorcade._run import OBJECT_DTYPE, Run, run
from motorcade._tracker import Axes, Image, Log, Policy, Tracker

__version__ = _motorcade.version()
__all__ = [
    "OBJECT_DTYPE",
    "Axes",
    "Camera",
    "Cause",
    "Counts",
    "Distortion",
    "Error",
    "Image",
    "Kind",
    "Lens",
    "Log",
    "LogLevel",
    "Mask",
    "Object",
    "Pair",
    "Policy",
    "Push",
    "PushStatus",
    "Recording",
    "Result",
    "Rig",
    "Run",
    "Sigmas",
    "State",
    "Status",
    "Tracker",
    "run",
]
