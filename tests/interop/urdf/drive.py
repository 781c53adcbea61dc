"""Drives a Husky through a URDF world under Bullet.

    drive.py PACKAGE_DIR GRAPH_JSON PICTURE.png

Bullet loads the world and knows nothing of our exporter; the Husky is that of `pybullet_data`. It starts in
one of the start frames and follows the line of the graph for 20 m, along the flattest way that leads there. It must
arrive on its wheels and in the cave, near the line, without sinking into the floor. The picture shows the way from above and
from the side.
"""

import json
import math
import sys
from pathlib import Path

import numpy as np
import pybullet as p
from package import require, run
from picture import draw
from world import hits, loaded, start_poses

sys.path.append(str(Path(__file__).parents[1]))
from husky import STEP_S, Husky  # noqa: E402

WAY_M = 20.0
GOAL_M = 21.0  # along the line, because corners are cut
SPARE_M = 1.5  # beyond it, to look ahead at
LINE_STEP_M = 0.1

TICK_STEPS = 12
PATIENCE_S = 60.0

SPEED_M_S = 0.8
LOOK_AHEAD_M = 1.2  # tuned: less and it weaves, more and it cuts corners
TURN_PER_S = 1.5
SKID = 1.9  # four wheels that cannot steer turn slower than two would; the ROS driver of the Husky says 1.875

EYE_M = 0.6
GROUND_M = 0.15
START_M = 0.05  # above the start frame
AWAY_M = 1.0
TILT_DEG = 35.0
DEPTH_M = 0.03
LIFT_M = 0.25
UP, DOWN = np.array([0, 0, 1.0]), np.array([0, 0, -1.0])


def verify(package, graph, picture):
    with loaded(package) as world:
        poses = start_poses(world)
        check_grounded(poses)
        (position, rotation), line = flattest(poses, ways(json.loads(Path(graph).read_text())))
        husky = Husky(position + START_M * UP, rotation)
        track = drive(husky, world, line)
        p.removeBody(husky.body)
        moved = np.abs(p.getBasePositionAndOrientation(world)[0]).max()
        floor, ceiling = hits(track["position"] + 0.1 * UP, DOWN), hits(track["position"] + 0.1 * UP, UP)
        draw(picture, line, track, floor, ceiling)
    require(moved == 0, f"the world has moved by {moved:.3f} m")
    summary = check(track, line, floor, ceiling)
    return f"Bullet: the Husky {summary}; see {picture}"


def check_grounded(poses):
    positions = np.array([position for position, _ in poses])
    floor = hits(positions + EYE_M * UP, DOWN)
    for number, height_m in enumerate(positions[:, 2] - floor[:, 2]):
        require(np.isfinite(height_m), f"there is no floor under start frame {number}")
        require(abs(height_m) < GROUND_M, f"start frame {number} is {height_m:.2f} m above the floor")


def ways(graph):
    """Every way along the passages that is long enough, as corners of shape (corner, xyz)."""
    points = {node["id"]: np.array([node["coordinates"][axis] for axis in "xyz"]) for node in graph["nodes"]}
    edges = {node["id"]: node["edges"] for node in graph["nodes"]}

    def longer(way, length_m):
        if length_m >= GOAL_M + SPARE_M:
            yield np.array([points[node] for node in way])
            return
        for node in set(edges[way[-1]]).difference(way):
            yield from longer([*way, node], length_m + math.dist(points[way[-1]], points[node]))

    return [way for node in points for way in longer([node], 0.0)]


def flattest(poses, ways):
    """The start pose and the line on the floor, shape (point, xyz), along the way that is least steep over any metre."""
    found = []
    for position, rotation in poses:
        ahead = np.array(p.getMatrixFromQuaternion(rotation)).reshape(3, 3)[:, 0]
        for way in ways:
            is_here = np.linalg.norm((way[0] - position)[:2]) < AWAY_M
            if is_here and ahead @ (way[1] - way[0]) > 0:
                line = on_floor(way)
                metre = round(1 / LINE_STEP_M)
                found.append((np.abs(line[metre:, 2] - line[:-metre, 2]).max(), len(found), (position, rotation), line))
    require(found, f"no way of {GOAL_M + SPARE_M} m leads from a start frame")
    return min(found)[2:]


def on_floor(way):
    lengths = np.r_[0, np.cumsum(np.linalg.norm(np.diff(way, axis=0), axis=1))]
    along = np.arange(0, lengths[-1], LINE_STEP_M)
    points = np.stack([np.interp(along, lengths, way[:, axis]) for axis in range(3)], axis=1)
    line = hits(points, DOWN)
    holes = points[np.isnan(line[:, 2])].round(1).tolist()
    require(not holes, f"there is no floor under {len(holes)} points of a way, the first of them {holes[:1]}")
    return line


def drive(husky, world, line):
    """Follows the line; returns the observations of each tick, until the end of the line or the time limit."""
    track = {"position": [], "up": [], "depth_m": [], "line": []}
    nearest = 0
    for _ in range(round(PATIENCE_S / STEP_S / TICK_STEPS)):
        position, axes = husky.position, husky.axes
        nearest = follow(line, nearest, position)
        track["position"].append(position)
        track["up"].append(axes[2, 2])
        track["depth_m"].append(max((-contact[8] for contact in p.getContactPoints(husky.body, world)), default=0.0))
        track["line"].append(nearest)
        if nearest * LINE_STEP_M >= GOAL_M:
            break
        target = axes.T @ (line[min(nearest + round(LOOK_AHEAD_M / LINE_STEP_M), len(line) - 1)] - position)
        off_course_rad = math.atan2(target[1], target[0])
        husky.steer(SPEED_M_S * max(math.cos(off_course_rad), 0.0), SKID * TURN_PER_S * off_course_rad)
        husky.run(TICK_STEPS * STEP_S)
    return {key: np.array(values) for key, values in track.items()}


def follow(line, nearest, position):
    """The nearest point of the line within the next metre; it never goes back."""
    some = line[nearest : nearest + round(1 / LINE_STEP_M)]
    return nearest + int(np.argmin(np.linalg.norm((some - position)[:, :2], axis=1)))


def check(track, line, floor, ceiling):
    """Holds the track to what a drive is; gives the summary."""
    position = track["position"]
    lost = int(np.isnan(floor[:, 2]).sum() + np.isnan(ceiling[:, 2]).sum())
    require(lost == 0, f"the Husky left the cave: no rock under or over it {lost} times")
    lift_m = np.abs(position[:, 2] - floor[:, 2]).max()
    require(lift_m < LIFT_M, f"the Husky was {lift_m:.2f} m off the floor")
    tilt_deg = math.degrees(math.acos(track["up"].min()))
    require(tilt_deg < TILT_DEG, f"the Husky leaned over by {tilt_deg:.0f} degrees")
    depth_m = track["depth_m"].max()
    require(depth_m < DEPTH_M, f"the Husky sank {depth_m * 1000:.0f} mm into the rock")
    away_m = np.linalg.norm((position - line[track["line"]])[:, :2], axis=1).max()
    require(away_m < AWAY_M, f"the Husky was {away_m:.2f} m off the line")
    way_m, driven_m = track["line"][-1] * LINE_STEP_M, np.linalg.norm(np.diff(position, axis=0), axis=1).sum()
    duration_s = len(position) * TICK_STEPS * STEP_S
    require(
        min(way_m, driven_m) >= WAY_M, f"the Husky came only {min(way_m, driven_m):.1f} m far in {duration_s:.0f} s"
    )
    return (
        f"drove {driven_m:.1f} m in {duration_s:.1f} s, at most {away_m:.2f} m off the line, "
        f"{tilt_deg:.0f} degrees from upright and {depth_m * 1000:.1f} mm in the rock"
    )


if __name__ == "__main__":
    run(verify)
