"""Follows a recorded drive and plots the paths of camera and objects from above, and how fast they are.

    drive.py DRIVE [--frames N] [--out plot.png]

Cells are marked `# %%`, so that an editor can run them one by one.
"""

# %% What to follow
import argparse
import os
import sys

import matplotlib
import numpy as np

import motorcade

arguments = argparse.ArgumentParser(description="Plots a recorded drive: paths from above, and speeds.")
arguments.add_argument("drive", help="folder of a recorded drive")
arguments.add_argument("--frames", type=int, help="follow the first ones alone")
arguments.add_argument("--out", help="write the plot there instead of showing it")
chosen = arguments.parse_args()

has_display = sys.platform != "linux" or "DISPLAY" in os.environ or "WAYLAND_DISPLAY" in os.environ
if chosen.out or not has_display:
    matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402  the backend is chosen before

# %% Follow it: arrays with a row for each frame, and for each object in each frame
try:
    run = motorcade.run(chosen.drive, chosen.frames)
except motorcade.Error as error:
    sys.exit(f"{sys.argv[0]}: {error}")
if len(run.frame) == 0:
    sys.exit(f"{sys.argv[0]}: {chosen.drive} gave no results")
objects = run.objects
start_ns = run.stamp_ns[0]
print(f"{len(run.frame)} frames, {np.count_nonzero(run.status == motorcade.Status.GOOD)} of them good, "
      f"{len(np.unique(objects['id']))} objects")

# %% An object's kind is that of most of its frames; a path takes a few frames
FEWEST_FRAMES = 5
ids, frames = np.unique(objects["id"], return_counts=True)
ids = ids[frames >= FEWEST_FRAMES]


def label(rows: np.ndarray) -> str:
    kinds, counts = np.unique(rows["kind"], return_counts=True)
    return f"{rows['id'][0]} {kinds[counts.argmax()].replace('_', ' ')}"


def with_gaps(frame: np.ndarray, values: np.ndarray) -> np.ndarray:
    """With a row of NaN where frames are missing, so that no line bridges them."""
    gaps = np.flatnonzero(np.diff(frame) > 1) + 1
    return np.insert(values.astype(float), gaps, np.nan, axis=0)


def speed_and_sigma(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of the velocity's length v: sigma^2 = n^T C n with n along the velocity."""
    velocity, covariance = rows["velocity_world_mps"], rows["velocity_covariance"]
    speed = np.linalg.norm(velocity, axis=1)
    along = velocity / np.maximum(speed, 1e-3)[:, np.newaxis]
    return speed, np.sqrt(np.maximum(np.einsum("ni,nij,nj->n", along, covariance, along), 0))


def draw_path(axes: plt.Axes, frame: np.ndarray, p_world: np.ndarray, name: str, **style: object) -> None:
    """From above, with a dot where it begins, and at its end an arrow and the name."""
    path = with_gaps(frame, p_world[:, [0, 2]])
    (line,) = axes.plot(path[:, 0], path[:, 1], **style)
    axes.plot(*path[0], "o", color=line.get_color(), markersize=4)
    axes.annotate("", xy=path[-1], xytext=path[-2], arrowprops={"arrowstyle": "-|>", "color": line.get_color()})
    axes.annotate(name, xy=path[-1], xytext=(6, 3), textcoords="offset points", color=line.get_color())


# %% Paths from above: x to the right, z ahead; the panel is as wide as the drive is
camera_path = run.T_world_cam[:, :3, 3]
tracks = {one: objects[objects["id"] == one] for one in ids}
corners = np.concatenate([camera_path] + [rows["T_world_body"][:, :3, 3] for rows in tracks.values()])
across_m, _, ahead_m = np.ptp(corners, axis=0)
shape = float(np.clip(across_m / max(ahead_m, 1.0), 0.35, 1.2))
figure, (above, speeds) = plt.subplots(
    1, 2, figsize=(13, 6.5), layout="constrained", gridspec_kw={"width_ratios": [shape, 1.3]})
folder_name = os.path.basename(os.path.normpath(chosen.drive))
figure.suptitle(f"{folder_name}: {len(run.frame)} frames, {(run.stamp_ns[-1] - start_ns) / 1e9:.1f} s")
colors = {one: plt.get_cmap("tab10")(index % 10) for index, one in enumerate(ids)}
for one, rows in tracks.items():
    draw_path(above, rows["frame"], rows["T_world_body"][:, :3, 3], str(one), color=colors[one])
draw_path(above, run.frame, camera_path, "camera", color="black", linewidth=2)
above.set(xlabel="x, to the right [m]", ylabel="z, ahead [m]", title="From above")
above.margins(0.08)
above.set_aspect("equal", adjustable="datalim")
above.grid(alpha=0.3)

# %% Speeds with bands of two sigma
time_s = (run.stamp_ns - start_ns) / 1e9
own_speed = np.linalg.norm(run.velocity[:, :3], axis=1)
speeds.plot(time_s[1:], own_speed[1:], color="black", linewidth=2, label="camera")
for one, rows in tracks.items():
    speed, sigma = speed_and_sigma(rows)
    seconds = with_gaps(rows["frame"], (rows["stamp_ns"] - start_ns) / 1e9)
    middle, wide = with_gaps(rows["frame"], speed), with_gaps(rows["frame"], 2 * sigma)
    speeds.plot(seconds, middle, color=colors[one], label=label(rows))
    speeds.fill_between(seconds, middle - wide, middle + wide, color=colors[one], alpha=0.2, linewidth=0)
speeds.set(xlabel="time [s]", ylabel="speed [m/s]", title="Speeds, with bands of two sigma")
speeds.set_ylim(bottom=0)
speeds.grid(alpha=0.3)
speeds.legend(loc="lower right")

# %% Show it
if chosen.out:
    figure.savefig(chosen.out, dpi=120)
    print(f"{chosen.out} is written")
elif has_display:
    plt.show()
else:
    sys.exit(f"{sys.argv[0]}: there is no display; --out plot.png writes the plot")
