"""Drives the rover of a MuJoCo package twice, with and without the sleep flag that the package switches on.

    sleep.py PACKAGE_DIR

Without movable things both trajectories must be the same to the last bit. The last line tells how much faster steps are.
"""

import time

import mujoco
import numpy as np
from package import name_of, require, run
from rover import Rover

DURATION_S = 6.0
SLICE_S = 0.1
SPEED_M_S = 0.4
SLEEP = int(mujoco.mjtEnableBit.mjENBL_SLEEP)


def verify(package):
    name = name_of(package)
    model = mujoco.MjModel.from_xml_path(str(package / f"{name}_rover.xml"))
    require(model.opt.enableflags & SLEEP, "the package does not switch sleep on")
    asleep, fast_us = drive(model, name)
    model.opt.enableflags &= ~SLEEP
    awake, slow_us = drive(model, name)
    is_alone = model.nbody == mujoco.MjModel.from_xml_path(str(package / "rover.xml")).nbody
    same = np.array_equal(asleep, awake)
    require(same or not is_alone, "the rover goes another way when static bodies sleep")
    told = "bit-identical" if same else "different, since stones move"
    return (
        f"MuJoCo: steps of {fast_us:.0f} µs with sleep, {slow_us:.0f} µs without: {slow_us / fast_us:.2f} times as fast; "
        f"trajectories of {DURATION_S:g} s {told}"
    )


def drive(model, name):
    """Where the rover was, and the time of a step in its fastest slices."""
    rover, places, times_s = Rover(model, name), [], []
    for slice in range(round(DURATION_S / SLICE_S)):
        rover.steer(SPEED_M_S if slice * SLICE_S < DURATION_S / 2 else -SPEED_M_S, 0)
        began_s = time.perf_counter()
        rover.run(SLICE_S)
        times_s.append(time.perf_counter() - began_s)
        places.append(rover.data.qpos.copy())
    return np.array(places), np.median(times_s) / round(SLICE_S / model.opt.timestep) * 1e6


if __name__ == "__main__":
    run(verify)
