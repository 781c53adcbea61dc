"""Judges a recording by ORB-SLAM3.

    judge.py NAME SENSOR RUN_DIR VOCABULARY OUT_DIR

SENSOR is rgbd, stereo or mono. Writes OUT_DIR/NAME.json, and OUT_DIR/NAME.tum with the trajectory.
"""

import json
import os
import sys
from pathlib import Path

import numpy as np
from errors import errors
from features import features
from recording import Recording
from tracking import track


def judge(name, sensor, folder, vocabulary, out):
    recording = Recording.read(folder)
    trajectory = out / f"{name}.tum"
    tracking = track(recording, sensor, vocabulary, trajectory)
    result = {
        "variant": name,
        "sensor": sensor,
        "frames": len(recording.times),
        "tracked": float(np.mean(tracking.is_tracked)),
        "points": float(np.median(tracking.points)),
        "loops": tracking.loops,
        "cpu_s_per_frame": tracking.cpu_s,
        **errors(recording, trajectory, has_scale=sensor != "mono"),
    }
    if sensor == "rgbd":
        result |= features(recording)
    part = out / f"{name}.part"
    part.write_text(json.dumps(result, indent=2) + "\n", encoding="ascii")
    part.replace(out / f"{name}.json")


if __name__ == "__main__":
    name, sensor, *places = sys.argv[1:]
    judge(name, sensor, *map(Path, places))
    # ORB-SLAM3's threads outlive it.
    os._exit(0)
