"""Drives the rover of MuJoCo packages from their start to the station that is furthest from it along the passages.

    traverse.py CAVE_DIR PACKAGE_DIR [CAVE_DIR PACKAGE_DIR ...]

The corridor is to be free of what wheels cannot take: the rover must arrive, without a stop of ten seconds and without leaning
more than 50 degrees. A line for each cave; fails if the rover does not arrive in one of them.
"""

import plume
from drive import follow
from package import require, run
from pursuit import LEAN_DEG, SPEED_M_S
from route import longest_route
from rover import Rover

NEAR_M = 1.0  # of the last station: passages end a little before it
SLOWNESS = 3.0  # of a rover that turns, climbs and slips


def verify(*folders):
    pairs = list(zip(folders[::2], folders[1::2], strict=True))
    arrived = sum(drive_through(folder, package) for folder, package in pairs)
    said = f"the rover arrives in {arrived} of {len(pairs)} caves"
    require(arrived == len(pairs), said)
    return f"MuJoCo: {said}"


def drive_through(folder, package):
    """Whether the rover arrives; prints how far it came."""
    rover = Rover.of(package)
    rover.run(1.0)  # it comes down on its wheels
    with plume.open(folder) as cave:
        line = longest_route(cave.graph.positions, cave.graph.edges, rover.position)
    goal_m = line.length_m - NEAR_M
    track = follow(rover, line, goal_m, SLOWNESS * line.length_m / SPEED_M_S)
    passed_m, lean_deg = track.along_m[-1], track.lean_deg
    arrives = bool(passed_m >= goal_m and lean_deg <= LEAN_DEG)
    outcome = "arrives" if arrives else f"ends at {track.grounds[-1].round(2)}"
    driven = f"{passed_m:.1f} of {goal_m:.1f} m in {track.times_s[-1]:.0f} s"
    print(f"{folder.name} {outcome}: {driven}, leans {lean_deg:.0f} degrees", flush=True)
    return arrives


if __name__ == "__main__":
    run(verify)
