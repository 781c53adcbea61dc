"""Renders the rover in its cave with MuJoCo's own renderer.

    picture.py PACKAGE_DIR OUT.png

MUJOCO_GL chooses the library: `osmesa` (Debian: libosmesa6) draws without a screen. The picture is to be looked at; checked is only
that it is not all dark or all bright.
"""

import mujoco
import numpy as np
from package import require, run
from PIL import Image
from rover import Rover

SIZE_PX = (1280, 720)
LEAST_SPREAD = 10  # of grey levels: a picture that is all dark or all bright has less


def verify(package, out):
    rover = Rover.of(package)
    rover.steer(0.5, 0.0)
    rover.run(2.0)
    width, height = SIZE_PX
    with mujoco.Renderer(rover.model, height, width) as renderer:
        renderer.update_scene(rover.data, camera="rover_chase")
        pixels = brightened(renderer.render())
    Image.fromarray(pixels).save(out)
    spread = pixels.mean(axis=2).std()
    require(spread > LEAST_SPREAD, f"{out} shows next to nothing: its grey levels spread over {spread:.0f}")
    return f"MuJoCo: a picture of the rover in {out}"


def brightened(pixels):
    """The renderer reads base colours as sRGB, computes in linear light and leaves it at that; screens expect sRGB."""
    return np.round(255 * (pixels / 255) ** (1 / 2.2)).astype(np.uint8)


if __name__ == "__main__":
    run(verify)
