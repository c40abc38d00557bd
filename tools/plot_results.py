#!/usr/bin/python3
"""Draws the figures of docs/results.md from the tables beside them: tools/plot_results.py [FOLDER]

Reads camera.csv, objects.csv, coverage_real.csv and cost_by_stage.csv in docs/results, writes an SVG beside each. Needs matplotlib.
The same tables give the same bytes.
"""
import csv
import pathlib
import sys

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
from matplotlib.ticker import LogLocator, NullLocator

plt.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "motorcade", "font.family": "sans-serif", "font.size": 9, "axes.spines.top": False,
                     "axes.spines.right": False, "axes.grid": True, "axes.grid.axis": "x", "grid.color": "#dddddd", "legend.frameon": False})
# Colors that color-blind readers can tell apart (Okabe and Ito 2008), and that are legible on white.
BLUE, ORANGE, GREEN, GRAY = "#0072B2", "#D55E00", "#009E73", "#888888"
SHADES = [GRAY, "#56B4E9", BLUE, GREEN, "#E69F00", ORANGE, "#CC79A7"]


def read(folder, name):
    with open(folder / name, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def canvas(rows, height_per_row):
    figure, axes = plt.subplots(figsize=(7.2, 0.9 + height_per_row * rows))
    axes.set_axisbelow(True)
    axes.invert_yaxis()
    return figure, axes


def save(figure, path):
    figure.savefig(path, metadata={"Date": None}, bbox_inches="tight", facecolor="white")
    plt.close(figure)
    print(f"{path}: {path.stat().st_size / 1000:.0f} kB")


def dots(rows, columns, label, path):
    """A row per drive and a dot per method, on a logarithmic axis: methods differ by factors."""
    figure, axes = canvas(len(rows), 0.26)
    for place, row in enumerate(rows):
        values = [float(row[column]) for column, *_ in columns if row[column]]
        axes.plot([min(values), max(values)], [place, place], color="#cccccc", zorder=1)
    for column, name, color, marker in columns:
        found = [(float(row[column]), place) for place, row in enumerate(rows) if row[column]]
        axes.scatter(*zip(*found), color=color, marker=marker, s=28, label=name, zorder=2)
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.xaxis.set_minor_locator(NullLocator())
    axes.set_yticks(range(len(rows)), [row["drive"] for row in rows])
    axes.set_xlabel(label)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 1.13), ncol=len(columns))
    save(figure, path)


def coverage(rows, path):
    figure, axes = canvas(len(rows), 0.4)
    for place, row in enumerate(rows):
        for offset, part, color in ((-0.18, "position", BLUE), (0.18, "rotation", ORANGE)):
            share = float(row[f"{part}_in_95_percent"])
            axes.barh(place + offset, share, 0.32, color=color, label=part if place == 0 else None)
            axes.text(share + 1, place + offset, f"{share:.0f}", va="center", fontsize=8)
    axes.axvline(95, color="black", linewidth=1, linestyle="--")
    axes.set_yticks(range(len(rows)), [row["drive"] for row in rows])
    axes.set_xlim(0, 108)
    axes.set_xlabel("motions over ten frames inside their 95 % region [%]; the dashed line is right")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 1.22), ncol=2)
    save(figure, path)


def cost(rows, path):
    stages = [column for column in rows[0] if column.endswith("_ms") and column != "all_ms"]
    figure, axes = canvas(len(rows), 0.32)
    for place, row in enumerate(rows):
        left = 0.0
        for stage, color in zip(stages, SHADES):
            width = float(row[stage])
            axes.barh(place, width, 0.62, left=left, color=color, label=stage[:-3].replace("_", " ") if place == 0 else None)
            left += width
        axes.text(left + 0.15, place, f"{float(row['all_ms']):.1f}", va="center", fontsize=8)
    axes.set_yticks(range(len(rows)), [row["input"] for row in rows])
    axes.set_xlim(0, max(float(row["all_ms"]) for row in rows) * 1.1)
    axes.set_xlabel("CPU time of a pair by stage, one thread, images in memory [ms]; the number is all of it")
    axes.legend(loc="upper center", bbox_to_anchor=(0.42, 1.28), ncol=4, fontsize=8)
    save(figure, path)


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent / "docs/results")
    dots(read(folder, "camera.csv"),
         [("ate_m", "joint", BLUE, "o"), ("front_end_ate_m", "front-end alone", GREEN, "s"), ("viso2_ate_m", "VISO2-S", ORANGE, "D")],
         "ATE of the camera [m]", folder / "camera.svg")
    dots(read(folder, "objects.csv"),
         [("me_t_m_joint", "joint", BLUE, "o"), ("me_t_m_pose_graph", "pose_graph", GREEN, "s"), ("me_t_m_filter", "filter", ORANGE, "D"),
          ("me_t_m_filter_map", "filter_map", GRAY, "v")],
         "error of an object's motion per frame, ME_t [m]", folder / "objects.svg")
    coverage(read(folder, "coverage_real.csv"), folder / "coverage_real.svg")
    cost([row for row in read(folder, "cost_by_stage.csv") if "x" not in row["input"] and "at most" not in row["input"] or "default" in row["input"]],
         folder / "cost_by_stage.svg")


if __name__ == "__main__":
    main()
