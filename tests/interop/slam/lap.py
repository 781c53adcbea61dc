"""Makes a lap of the loop in a path of `plume path --kind loop`, and a little more.

    lap.py PATH.tum LAP.tum

Such a path leads to the loop and back, and its robot turns on the spot: places are seen again, but never in the same direction, and
no SLAM program knows them again. The lap begins where the loop closes, goes round at a constant speed, and goes on over its own
beginning. Corners are rounded, by less than the clearance that a robot has.
"""

import sys
from pathlib import Path

import numpy as np

SPEED_M_S = 1.0
AGAIN_M = 7.0  # that are seen twice
SHORTEST_M = 10.0  # of what counts as a loop
CLOSE_M = 0.5  # passages with this between two poses are open to each other: robots are wider
STEP_M = 0.02
ROUND_M = 0.4  # standard deviation of the smoothing
EVERY_M = 0.1  # poses that are written


def lap(places):
    """Places along the lap every STEP_M, and headings."""
    loop = resampled(loop_of(places))
    loop = resampled(smoothed(loop))
    ahead = np.roll(loop, -1, axis=0) - np.roll(loop, 1, axis=0)
    ahead = smoothed(ahead / np.linalg.norm(ahead, axis=1, keepdims=True))
    again = round(AGAIN_M / STEP_M)
    return np.concatenate([loop, loop[:again]]), np.unwrap(
        np.tile(np.arctan2(ahead[:, 1], ahead[:, 0]), 2)[: len(loop) + again]
    )


def loop_of(places):
    """The shortest part of the path that comes back to where it began: the way there and back makes any other longer."""
    along = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(places, axis=0), axis=1))])
    between = along[None] - along[:, None]
    apart = np.linalg.norm(places[None] - places[:, None], axis=2)
    is_loop = (between > SHORTEST_M) & (apart < CLOSE_M)
    if not is_loop.any():
        sys.exit("the path has no loop")
    first, last = np.unravel_index(np.where(is_loop, between, np.inf).argmin(), between.shape)
    return places[first : last + 1]


def resampled(loop):
    """Closed, at steps of nearly STEP_M."""
    closed = np.concatenate([loop, loop[:1]])
    along = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1))])
    steps = np.linspace(0, along[-1], round(along[-1] / STEP_M), endpoint=False)
    return np.column_stack([np.interp(steps, along, axis) for axis in closed.T])


def smoothed(loop):
    """By a Gaussian that goes round."""
    waves = np.fft.rfftfreq(len(loop), STEP_M)
    damped = np.exp(-2 * (np.pi * waves * ROUND_M) ** 2)
    return np.fft.irfft(np.fft.rfft(loop, axis=0) * damped[:, None], len(loop), axis=0)


def lines(places, headings):
    stride = round(EVERY_M / STEP_M)
    for number, ((x, y, z), heading) in enumerate(zip(places[::stride], headings[::stride], strict=True)):
        time_s, half = number * EVERY_M / SPEED_M_S, heading / 2
        yield f"{time_s:.6f} {x:.6f} {y:.6f} {z:.6f} 0.0 0.0 {np.sin(half):.9f} {np.cos(half):.9f}\n"


def main():
    path, out = map(Path, sys.argv[1:])
    places = np.loadtxt(path)[:, 1:4]
    out.write_text("".join(lines(*lap(places))), encoding="ascii")


if __name__ == "__main__":
    main()
