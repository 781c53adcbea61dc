"""The picture of a drive: from above, with the walls at bumper height, and from the side."""

import numpy as np
from matplotlib.figure import Figure
from world import strikes

BUMPER_M = 0.3
WALL_MAX_UP = 0.7  # of a unit normal: more is floor that rises into the ray, or ceiling that comes down
RAYS = 720
EYES = 3  # points of the line from one look around to the next
MARGIN_M = 3.5
HUSKY_HEIGHT_M = 0.39
EXAGGERATION = 2


def draw(path, line, track, floor, ceiling):
    figure = Figure(figsize=(11, 12), layout="constrained")
    plan, side = figure.subplots(2, 1, height_ratios=[2, 1])
    draw_plan(plan, line, track["position"])
    draw_side(side, track["position"], floor, ceiling)
    figure.savefig(path, dpi=100)


def draw_plan(axes, line, driven):
    turn = np.linspace(0, 2 * np.pi, RAYS, endpoint=False)
    around = np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    for eye in line[::EYES]:
        seen, normals = strikes(eye + [0, 0, BUMPER_M], around)
        axes.fill(*seen[:, :2].T, color="0.9", linewidth=0, zorder=0)
        walls = seen[np.abs(normals[:, 2]) < WALL_MAX_UP]
        axes.plot(*walls[:, :2].T, ".", color="0.3", markersize=1.5, zorder=1)
    axes.plot(*line[:, :2].T, "--", color="tab:blue", label="line of the graph")
    axes.plot(*driven[:, :2].T, color="tab:red", label="Husky")
    axes.plot(*driven[0, :2], "o", color="tab:red", label="start frame")
    axes.plot(*driven[-1, :2], "s", color="tab:red", label="end")
    low, high = line.min(axis=0) - MARGIN_M, line.max(axis=0) + MARGIN_M
    axes.set(
        title=f"From above; grey: what is seen of the cave from the line, {BUMPER_M} m over the floor",
        xlabel="x in m",
        ylabel="y in m",
        aspect="equal",
        xlim=(low[0], high[0]),
        ylim=(low[1], high[1]),
    )
    axes.legend()


def draw_side(axes, driven, floor, ceiling):
    along_m = np.r_[0, np.cumsum(np.linalg.norm(np.diff(driven[:, :2], axis=0), axis=1))]
    low, high = np.nanmin(floor[:, 2]) - 0.5, np.nanmax(ceiling[:, 2]) + 0.5
    axes.fill_between(along_m, floor[:, 2], low, color="0.6", linewidth=0, label="rock under and over it")
    axes.fill_between(along_m, ceiling[:, 2], high, color="0.6", linewidth=0)
    axes.fill_between(
        along_m, driven[:, 2], driven[:, 2] + HUSKY_HEIGHT_M, color="tab:red", alpha=0.25, linewidth=0, label="Husky"
    )
    axes.plot(along_m, driven[:, 2], color="tab:red", linewidth=1.2, label="bottom of its wheels, in the middle")
    axes.set(
        title=f"From the side, heights {EXAGGERATION} times",
        xlabel="driven in m",
        ylabel="z in m",
        aspect=EXAGGERATION,
        xlim=(0, along_m[-1]),
        ylim=(low, high),
    )
    axes.legend(loc="upper center", ncols=3)
