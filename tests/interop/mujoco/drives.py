"""Holds certificates of caves to drives of the rover of their MuJoCo packages.

    drives.py [--passages N] PACKAGE_DIR CAVE_DIR [PACKAGE_DIR CAVE_DIR ...]

The rover is put down at the start, and follows by pure pursuit

- the path to the station that is furthest from the start of those that the certificate for it is sure of;
- the paths through passages that are called go or marginal, each way: of each at most N, the steepest first;
- the straight line between the stations of passages that are called no-go, likewise.

It fails where it is stuck for ten seconds, leans more than 50 degrees or strays by more than a metre. What is called go must be
driven to its end. Prints what was said of paths and what came of it.
"""

import argparse
import sys
from collections import Counter
from pathlib import Path

import numpy as np
import plume
from drive import CONTROL_S, LEAN_DEG, SPEED_M_S, STUCK_S, TURN_GAIN, TURN_MOST_RAD_S
from package import Failure, require
from route import Line
from rover import Rover
from scipy.spatial.transform import Rotation

LEAST_M = 0.5  # shorter paths are left out
LOOK_AHEAD_M = 0.4
ARRIVED_M = 0.3  # from the end
ABOVE_M = 0.02  # the rover is put down from here
STRAY_M = 1.0


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--passages", type=int, default=1000)
    arguments.add_argument("folders", nargs="+", type=Path)
    given = arguments.parse_args()
    try:
        print(verify(list(zip(given.folders[::2], given.folders[1::2], strict=True)), given.passages))
    except Failure as failure:
        sys.exit(str(failure))


def verify(caves, most):
    table, failed = Counter(), []
    for package, folder in caves:
        rover = Rover.of(package)
        with plume.open(folder) as cave:
            for said, name, poses in paths(cave, most):
                fault, passed_m, length_m = drive(rover, poses)
                table[said, fault is None] += 1
                if said == "go" and fault is not None:
                    failed.append(f"{folder.name} {name}: {fault} after {passed_m:.1f} of {length_m:.1f} m")
                    print(failed[-1], flush=True)
        print(folder.name, summary(table), flush=True)
    require(not failed, f"{len(failed)} paths that are called go were not driven")
    return f"MuJoCo: the rover drives every path that is called go; {summary(table)}"


def summary(table):
    said = [f"{said} {table[said, True]} driven, {table[said, False]} not" for said in ("go", "marginal", "no-go")]
    return "; ".join(said)


def paths(cave, most):
    """What is said of a path, its name and its poses."""
    certificate = cave.certify("rover")
    if certificate["route"]:
        yield "go", f"to {certificate['route']['to']}", np.array(certificate["route"]["path"])
    ids = [node["id"] for node in cave.graph.to_dict()["nodes"]]
    places = dict(zip(ids, cave.graph.positions, strict=True))
    found = {"go": [], "marginal": [], "no-go": []}
    for passage in certificate["passages"]:
        for way, start, end in (("there", "from", "to"), ("back", "to", "from")):
            verdict, ids = passage[way], [passage[start], passage[end]]
            path = np.array(verdict["path"] or straight(*[places[station] for station in ids]))
            if Line(path[:, :3]).length_m >= LEAST_M:
                found[verdict["class"]].append((f"{ids[0]}..{ids[1]}", path))
    for said, named in found.items():
        named.sort(key=lambda one: -np.abs(one[1][:, 4]).max())
        yield from ((said, name, path) for name, path in named[:most])


def straight(one, other):
    """A path along the line between two stations, which hang in the air."""
    heading_deg = np.degrees(np.arctan2(other[1] - one[1], other[0] - one[0]))
    points = np.linspace(one, other, max(int(np.linalg.norm(other - one) / 0.1), 2))
    return [[*point, heading_deg, 0.0, 0.0] for point in points]


def drive(rover, poses):
    """What stops the rover, how far it came, and how far it was to go."""
    put_down(rover, poses[0])
    line = Line(poses[:, :3])
    passed_m, passed_at_s = 0.0, rover.data.time
    while passed_m < line.length_m - ARRIVED_M:
        before_m, passed_m = passed_m, line.along_m(rover.position, passed_m, LOOK_AHEAD_M)
        passed_at_s = rover.data.time if passed_m > before_m else passed_at_s
        target = line.at(min(passed_m + LOOK_AHEAD_M, line.length_m)) - rover.position
        ahead, left, up = rover.axes.T
        off_course_rad = np.arctan2(target @ left, target @ ahead)
        turn_rad_s = np.clip(TURN_GAIN * off_course_rad, -TURN_MOST_RAD_S, TURN_MOST_RAD_S)
        rover.steer(SPEED_M_S * max(np.cos(off_course_rad), 0) ** 2, turn_rad_s)
        rover.run(CONTROL_S)
        if up[2] < np.cos(np.radians(LEAN_DEG)):
            return "tips over", passed_m, line.length_m
        if np.linalg.norm((line.at(passed_m) - rover.position)[:2]) > STRAY_M:
            return "strays", passed_m, line.length_m
        if rover.data.time > passed_at_s + STUCK_S:
            return "is stuck", passed_m, line.length_m
    return None, passed_m, line.length_m


def put_down(rover, pose):
    """At rest, as the pose stands."""
    rotation = Rotation.from_euler("ZYX", pose[3:] * [1, -1, 1], degrees=True)
    x, y, z, w = rotation.as_quat()
    address = rover.model.jnt_qposadr[rover.model.body("rover").jntadr[0]]
    rover.data.qvel[:] = 0
    rover.data.ctrl[:] = 0
    rover.data.qpos[address : address + 7] = [*pose[:3] + rotation.apply([0, 0, ABOVE_M]), w, x, y, z]
    rover.run(0.5)


if __name__ == "__main__":
    main()
