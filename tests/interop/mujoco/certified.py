"""Drives the rover of a MuJoCo package along paths that Plume calls passable for it.

    certified.py PACKAGE_DIR PATH.tum [PATH.tum ...]

Paths are on wheels (`plume path --robot rover`). The rover is put down at the start of each, and must come to its end without a
stop of ten seconds and without leaning more than 50 degrees. Its place is followed within half a metre of look-ahead, so it turns
on the spot where the path does.
"""

import numpy as np
from drive import LEAN_DEG, STUCK_S
from package import require, run
from route import Line
from rover import Rover

SPEED_M_S = 0.5
LOOK_AHEAD_M = 0.4
TURN_GAIN = 3.0
TURN_MOST_RAD_S = 1.5
CONTROL_S = 0.1
ARRIVED_M = 0.3  # from the end
ABOVE_M = 0.05  # the rover is put down from here
STRAY_M = 1.0


def verify(package, *paths):
    rover = Rover.of(package)
    for path in paths:
        fault, passed_m, length_m = drive(rover, np.loadtxt(path))
        require(fault is None, f"{path.name}: the rover {fault} after {passed_m:.1f} of {length_m:.1f} m")
    return f"MuJoCo: the rover drives {len(paths)} paths to their ends"


def drive(rover, poses):
    """What stops the rover, how far it came, and how far it was to go."""
    put_down(rover, poses[0])
    line = Line(poses[:, 1:4])
    passed_m, passed_at_s = 0.0, rover.data.time
    while passed_m < line.length_m - ARRIVED_M:
        if rover.data.time > passed_at_s + STUCK_S:
            return "is stuck", passed_m, line.length_m
        before_m, passed_m = passed_m, line.along_m(rover.position, passed_m, LOOK_AHEAD_M)
        passed_at_s = rover.data.time if passed_m > before_m + 1e-6 else passed_at_s
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
    return None, passed_m, line.length_m


def put_down(rover, pose):
    """At rest, as the pose stands."""
    _, x, y, z, qx, qy, qz, qw = pose
    start = rover.model.body("rover").jntadr[0]
    address = rover.model.jnt_qposadr[start]
    rover.data.qvel[:] = 0
    rover.data.ctrl[:] = 0
    rover.data.qpos[address : address + 7] = [x, y, z + ABOVE_M, qw, qx, qy, qz]
    rover.run(1.0)


if __name__ == "__main__":
    run(verify)
