"""Renders a USD package from its View camera in Blender's Cycles, to be looked at; checks nothing.

    picture.py PACKAGE_DIR PICTURE.png

Needs bpy 4.2, which is a Blender of 1.5 GB without a window, and runs on the CPU. Blender reads the stage with a USD of its
own. A lamp at the camera replaces the lamps of the package, which may be none, or as strong as the camera of Isaac Sim
wants them.
"""

import os
import sys
from pathlib import Path

import bpy

LAMP_W = 400.0  # tuned by eye for passages of some metres
SAMPLES = 48
SIZE_PX = (640, 360)


def main(folder, picture):
    stages = sorted([*folder.glob("*.usda"), *folder.glob("*.usdz")])
    require(len(stages) == 1, f"expected one stage in {folder}, found {len(stages)}")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.usd_import(filepath=str(stages[0]), import_guide=False, set_frame_range=False)
    camera = next((thing for thing in bpy.data.objects if thing.type == "CAMERA"), None)
    require(camera is not None, "Blender finds no camera in the stage")
    light_up(camera)
    render(camera, picture)
    triangles = sum(len(mesh.polygons) for mesh in bpy.data.meshes)
    missing = [image.name for image in bpy.data.images if image.source == "FILE" and 0 in image.size]
    require(not missing, f"Blender finds no {missing}")
    print(f"Blender: {triangles} triangles, {len(bpy.data.images)} images, picture in {picture}")


def light_up(camera):
    for light in [thing for thing in bpy.data.objects if thing.type == "LIGHT"]:
        bpy.data.objects.remove(light)
    lamp = bpy.data.objects.new("headlamp", bpy.data.lights.new("headlamp", "POINT"))
    lamp.data.energy = LAMP_W
    lamp.matrix_world = camera.matrix_world
    bpy.context.scene.collection.objects.link(lamp)


def render(camera, picture):
    scene = bpy.context.scene
    scene.camera = camera
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = SAMPLES
    # A denoiser paints streaks into fine rock.
    scene.cycles.use_denoising = False
    scene.render.resolution_x, scene.render.resolution_y = SIZE_PX
    scene.render.filepath = str(picture)
    bpy.ops.render.render(write_still=True)


def require(condition, message):
    if not condition:
        sys.exit(f"error: {message}")


if __name__ == "__main__":
    require(len(sys.argv) == 3, "usage: picture.py PACKAGE_DIR PICTURE.png")
    main(Path(os.path.abspath(sys.argv[1])), Path(os.path.abspath(sys.argv[2])))
