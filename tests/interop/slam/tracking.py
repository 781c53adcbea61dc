"""ORB-SLAM3 on a recording (Campos et al., ORB-SLAM3, 2021), by the Python bindings `pyorbslam3`.

A frame comes when the threads that map and look for loops have nothing left to do, so that what they find does not depend on how
busy the machine is. They still run beside each other, so two runs differ a little. Linux only, as the bindings are.
"""

import threading
import time
from dataclasses import dataclass
from pathlib import Path

import pyorbslam3

POLL_S = 0.003  # as often as the threads look for work
IDLE_POLLS = 3
LONGEST_S = 20.0  # for the whole map to be moved


@dataclass
class Tracking:
    """What is told of every frame, at which of them the whole map moved, and CPU seconds a frame."""

    is_tracked: list[bool]
    points: list[int]
    loops: list[int]
    cpu_s: float


def track(recording, sensor, vocabulary, out):
    """Writes the trajectory that is left at the end: of all frames, or of key frames where there is only one camera."""
    follow, kind = SENSORS[sensor]
    slam = pyorbslam3.Slam(str(vocabulary), str(recording.settings), kind)
    told, loops = [], []
    start_s = time.process_time()
    for number, stamp in enumerate(recording.times):
        told.append(follow(slam, recording, number, float(stamp)))
        settle()
        if slam.map_changed():
            loops.append(number)
    cpu_s = (time.process_time() - start_s) / len(told)
    slam.shutdown()
    if any(frame.ok for frame in told):
        save = slam.save_keyframe_trajectory_tum if sensor == "mono" else slam.save_trajectory_tum
        save(str(out))
    return Tracking([frame.ok for frame in told], [frame.num_tracked_points for frame in told], loops, cpu_s)


def settle():
    idle, end_s = 0, time.monotonic() + LONGEST_S
    while idle < IDLE_POLLS and time.monotonic() < end_s:
        time.sleep(POLL_S)
        idle = 0 if is_busy() else idle + 1


def is_busy():
    """Whether any thread but this one runs, or would if it had a core."""
    others = [task for task in Path("/proc/self/task").iterdir() if int(task.name) != threading.get_native_id()]
    return any(state(task) in "RD" for task in others)


def state(task):
    """The letter of the kernel; that of a sleeper for a thread that has just ended."""
    try:
        return (task / "stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return "S"


def rgbd(slam, recording, number, stamp):
    return slam.track_rgbd(recording.grey(number), recording.depth(number), stamp)


def stereo(slam, recording, number, stamp):
    return slam.track_stereo(recording.grey(number), recording.grey(number, "right"), stamp)


def mono(slam, recording, number, stamp):
    return slam.track_monocular(recording.grey(number), stamp)


SENSORS = {
    "rgbd": (rgbd, pyorbslam3.Sensor.RGBD),
    "stereo": (stereo, pyorbslam3.Sensor.STEREO),
    "mono": (mono, pyorbslam3.Sensor.MONOCULAR),
}
