"""Drives the rover of a MuJoCo package along the passages of its cave.

    drive.py PACKAGE_DIR CAVE_DIR

From the start keyframe, where the rock must hold it by the friction of the recipe, it follows the centreline by pure pursuit: it
looks a metre ahead on the line and turns towards that point. It must pass 20 m of the line within two minutes, and on its way

- stay inside: the middle between its wheels is in the open by the visual mesh;
- stay on its wheels: it never leans more than 50 degrees;
- not sink: no spoke of a wheel reaches through the visual mesh by more than the tolerance of pieces on the floor, and 1 cm for
  the soft contacts of MuJoCo under a rover that comes down.

A plan and a profile are left next to the package: `<package>_drive.png`.
"""

from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np
import plume
from floor import heights_m
from package import TOLERANCE_M, Wall, require, run
from pursuit import LEAN_DEG, STUCK_S, Pursuit, is_tipped
from route import route
from rover import Rover
from scipy.spatial import cKDTree

ROUTE_M = 22.0
ARRIVED_M = 20.0
DURATION_S = 120.0
LOOK_AHEAD_M = 1.0
SPOKES = 24
SLACK_M = 0.01


class Track(NamedTuple):
    """Where the rover was, a row for each step of its control."""

    times_s: np.ndarray
    along_m: np.ndarray  # of the route
    hubs: np.ndarray  # middle between the wheels
    grounds: np.ndarray  # the origin, on the ground between the wheels
    ups: np.ndarray
    wheels: np.ndarray  # where each spoke starts
    spokes: np.ndarray  # its direction

    @property
    def lean_deg(self):
        """At most."""
        return np.degrees(np.arccos(self.ups[:, 2].clip(-1, 1))).max()


def verify(package, folder):
    rover, wall = Rover.of(package), Wall(package)
    rover.run(1.0)  # it comes down on its wheels
    with plume.open(folder) as cave:
        check_grip(rover, cave.recipe["world.friction"])
        line = route(cave.graph.positions, cave.graph.edges, rover.position, rover.axes[:, 0], ROUTE_M)
        track = follow(rover, line, ARRIVED_M, DURATION_S)
        picture = package.with_name(f"{package.name}_drive.png")
        plot(picture, cave, line, track)
    passed_m, lean_deg = track.along_m[-1], track.lean_deg
    open_m = wall.nearest(track.hubs)[1].min()
    sunk_m = rover.wheel_radius_m - wall.first_hits_m(track.wheels.reshape(-1, 3), track.spokes.reshape(-1, 3)).min()
    faults = [
        (passed_m < ARRIVED_M, f"gets no further than {passed_m:.1f} m"),
        (open_m < 0, f"leaves the cave by {-open_m:.2f} m"),
        (lean_deg > LEAN_DEG, f"leans {lean_deg:.0f} degrees"),
        (sunk_m > TOLERANCE_M["floor"] + SLACK_M, f"sinks {sunk_m:.3f} m into the rock"),
    ]
    said = [what for is_fault, what in faults if is_fault]
    require(not said, f"the rover {' and '.join(said)}: see {picture}")
    return (
        f"MuJoCo: the rover drives {passed_m:.1f} m in {track.times_s[-1]:.0f} s, leans {lean_deg:.0f} degrees and sinks "
        f"{sunk_m * 1000:.1f} mm at most: see {picture}"
    )


def check_grip(rover, friction):
    """The rover stands at its start pose: its friction must be that of the recipe, not that of the engine or the tyres."""
    grips = rover.data.contact.friction[:, 0]
    require(len(grips) > 0, "the rover does not stand on rock at the start")
    require(np.allclose(grips, friction), f"friction under the rover is {grips.round(3)}, and {friction} in the recipe")


def follow(rover, line, goal_m, duration_s):
    """Drives to that place on the line, or until the time is up or the rover is stuck or on its side."""
    pursuit, rows, passed_m, passed_at_s = Pursuit(rover), [], 0.0, rover.data.time
    while passed_m < goal_m and rover.data.time < min(duration_s, passed_at_s + STUCK_S):
        before_m, passed_m = passed_m, line.along_m(rover.position, passed_m, LOOK_AHEAD_M)
        passed_at_s = rover.data.time if passed_m > before_m else passed_at_s
        pursuit.steer(line.at(passed_m + LOOK_AHEAD_M))
        up = rover.axes[:, 2]
        hub = rover.position + rover.wheel_radius_m * up
        rows.append((rover.data.time, passed_m, hub, rover.position, up, *rover.spokes(SPOKES)))
        if is_tipped(rover):
            break
    return Track(*map(np.array, zip(*rows, strict=True)))


def plot(picture, cave, line, track):
    figure, (plan, profile) = plt.subplots(2, 1, figsize=(10, 11), height_ratios=[3, 2], layout="constrained")
    plot_plan(plan, cave, line, track)
    plot_profile(profile, cave, track)
    figure.savefig(picture, dpi=90)
    plt.close(figure)


def plot_plan(axes, cave, line, track):
    """The passage, half a metre over the centre of the route's floor, from above."""
    places_m = np.linspace(0, line.length_m, 200)
    grounds = line.at(places_m)
    tree = cKDTree(grounds[:, :2])
    low, high = grounds[:, :2].min(axis=0) - 4, grounds[:, :2].max(axis=0) + 4
    x, y = np.meshgrid(np.arange(low[0], high[0], 0.1), np.arange(low[1], high[1], 0.1))
    _, nearest = tree.query(np.stack([x, y], axis=-1))
    z = np.interp(places_m[nearest], track.along_m, track.grounds[:, 2]) + 0.5
    field_m = cave.field(np.stack([x, y, z], axis=-1).reshape(-1, 3)).reshape(x.shape)
    axes.contourf(x, y, field_m, levels=[-100, 0], colors=["#eeeeee"])
    axes.contour(x, y, field_m, levels=[0], colors=["black"])
    axes.plot(*line.corners.T[:2], "o--", color="tab:blue", label="centreline")
    axes.plot(*track.grounds.T[:2], color="tab:red", label="rover")
    axes.set(title="plan: rock half a metre above the rover's ground", xlabel="x, m", ylabel="y, m", aspect="equal")
    axes.legend()


def plot_profile(axes, cave, track):
    floors_m = track.grounds[:, 2] - heights_m(cave, track.grounds)
    axes.plot(track.along_m, floors_m, color="black", label="floor of the field under the rover's middle")
    axes.plot(track.along_m, track.grounds[:, 2], color="tab:red", label="rover, its ground")
    axes.set(title="profile", xlabel="along the centreline, m", ylabel="z, m")
    axes.legend()


if __name__ == "__main__":
    run(verify)
