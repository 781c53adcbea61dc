"""Draws a film strip of a recording: images above depth and labels, to be looked at.

strip.py RUN_DIR OUT.png
"""

import json
import sys
from pathlib import Path
from zlib import crc32

import cv2
import numpy as np
from recording import Recording

FRAMES = 6
WIDTH_PX = 480
NEAR_M, FAR_M = 0.3, 10.0


def strip(recording):
    numbers = np.linspace(0, len(recording.times) - 1, FRAMES).round().astype(int)
    columns = [
        np.vstack([image(recording, number), depth(recording, number), labels(recording, number)]) for number in numbers
    ]
    return np.hstack(columns)


def image(recording, number):
    return shrunk(cv2.imread(str(recording.folder / f"rgb/{recording.times[number]}.png")), cv2.INTER_AREA)


def depth(recording, number):
    """Bright is near; black is what the camera does not measure."""
    [units_per_m] = recording.numbers("RGBD.DepthMapFactor")
    depth_m = shrunk(recording.depth(number), cv2.INTER_NEAREST) / units_per_m
    near = 1 - np.log(np.maximum(depth_m, NEAR_M) / NEAR_M) / np.log(FAR_M / NEAR_M)
    shown = cv2.applyColorMap(np.round(255 * np.clip(near, 0, 1)).astype(np.uint8), cv2.COLORMAP_VIRIDIS)
    return np.where(depth_m[..., None] > 0, shown, 0).astype(np.uint8)


def labels(recording, number):
    """A colour for each class, the same in all strips."""
    about = json.loads((recording.folder / "recording.json").read_text(encoding="utf-8"))
    palette = np.zeros((256, 3), dtype=np.uint8)
    for row in about["labels"]:
        palette[row["label"]] = np.random.default_rng(crc32(row["class"].encode())).integers(40, 255, 3)
    found = cv2.imread(str(recording.folder / f"label/{recording.times[number]}.png"), cv2.IMREAD_UNCHANGED)
    return palette[shrunk(found, cv2.INTER_NEAREST)]


def shrunk(picture, how):
    height, width = picture.shape[:2]
    return cv2.resize(picture, (WIDTH_PX, height * WIDTH_PX // width), interpolation=how)


def main():
    folder, out = map(Path, sys.argv[1:])
    recording = Recording.read(folder)
    picture = strip(recording)
    cv2.imwrite(str(out), picture)
    print(f"{out}: {FRAMES} of {len(recording.times)} frames")


if __name__ == "__main__":
    main()
