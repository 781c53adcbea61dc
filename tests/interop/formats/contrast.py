"""Measures how much contrast pictures have at each scale, and fails if one is flat or blurred.

    contrast.py PICTURE...

Per picture a line: the standard deviation of the binary logarithm of the luminance in the octaves of 3-6, 6-11 and 11-22
pixels, and the 95th percentile of its gradient, of a picture 960 pixels wide. Each is the median over tiles that are lit.
"""

import sys

import bpy
import numpy as np

WIDTH = 960
TILE = 60
LIT = (0.012, 0.8)  # mean luminance of a tile that counts
DARKEST = 0.004  # what no lamp reaches has no contrast
FINEST_SIGMA = 0.7  # of the Gaussian that leaves waves of three pixels and more
# A little less than the flattest picture of the gallery has.
LEAST = (0.10, 0.12, 0.14, 0.52)


def main(pictures):
    flat = []
    for picture in pictures:
        found = contrast(luminance(picture))
        print(f"{picture}: {' '.join(f'{octave:.3f}' for octave in found[:-1])} | {found[-1]:.3f}")
        if any(has < least for has, least in zip(found, LEAST, strict=True)):
            flat.append(picture)
    if flat:
        sys.exit(f"error: flat or blurred: {', '.join(flat)}")


def luminance(picture):
    image = bpy.data.images.load(picture)
    image.scale(WIDTH, image.size[1] * WIDTH // image.size[0])
    width, height = image.size
    encoded = np.array(image.pixels[:], dtype=np.float64).reshape(height, width, -1)[..., :3]
    linear = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    return linear @ [0.2126, 0.7152, 0.0722]


def contrast(luminance):
    stops = np.log2(luminance + DARKEST)
    blurred = [smooth(stops, FINEST_SIGMA * 2**octave) for octave in range(4)]
    octaves = [fine - coarse for fine, coarse in zip(blurred[:-1], blurred[1:], strict=True)]
    slope = np.hypot(*np.gradient(stops))
    height, width = stops.shape
    corners = [(y, x) for y in range(0, height - TILE + 1, TILE) for x in range(0, width - TILE + 1, TILE)]
    tiles = [np.s_[y : y + TILE, x : x + TILE] for y, x in corners]
    lit = [tile for tile in tiles if LIT[0] < luminance[tile].mean() < LIT[1]]
    deviations = [np.median([octave[tile].std() for tile in lit]) for octave in octaves]
    return [*deviations, np.median([np.percentile(slope[tile], 95) for tile in lit])]


def smooth(values, sigma):
    reach = int(np.ceil(4 * sigma))
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    kernel /= kernel.sum()
    for axis in (0, 1):
        padding = [(reach, reach) if axis == at else (0, 0) for at in (0, 1)]
        padded = np.pad(values, padding, mode="symmetric")
        values = np.apply_along_axis(np.convolve, axis, padded, kernel, "valid")
    return values


if __name__ == "__main__":
    main(sys.argv[1:])
