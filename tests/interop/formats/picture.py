"""Renders a GLB package from one of its start poses in Blender's Cycles, for the gallery; checks nothing.

    picture.py PACKAGE_DIR PICTURE.jpg SPAWN

Needs bpy 4.2, which is a Blender of 1.5 GB without a window, and runs on the CPU. The lamps of the package are left out: a
headlamp beside the camera, so that relief casts shadows, and a lamp further along the passage light the scene, and nothing
else does.
"""

import json
import math
import os
import sys
import tempfile
from pathlib import Path

import bpy
from mathutils import Matrix, Quaternion, Vector

SIZE_PX = (1600, 900)
SAMPLES = 20
QUALITY = 90
EYE_M = 1.1  # of the camera above a start pose
SENSOR_MM, FOCAL_MM = 36.0, 21.5  # 80 degrees across
# Metres to the left of the camera and above it, and watts: tuned by eye for passages of some metres.
HEADLAMP_M, HEADLAMP_W = (0.36, 0.22), 260.0
AHEAD_M, AHEAD_W = (5.0, 0.3), 60.0
# Tuned by eye.
MEAN_LUMINANCE, DARK, MOST_STOPS = 0.095, 0.004, 2.5
FAR_M = 20.0  # chunks beyond are hidden, which saves time


def main(folder, picture, spawn):
    poses = json.loads((folder / "scene.json").read_text(encoding="utf-8"))["spawns"]
    require(spawn < len(poses), f"the package has {len(poses)} start poses")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for file in sorted(folder.glob("*.glb")):
        bpy.ops.import_scene.gltf(filepath=str(file), merge_vertices=False)
    for lamp in [object for object in bpy.data.objects if object.type in ("LIGHT", "CAMERA")]:
        bpy.data.objects.remove(lamp)
    eye, ahead = view_of(poses[spawn])
    meshes = [object for object in bpy.data.objects if object.type == "MESH"]
    require(meshes, f"Blender finds no mesh in {folder}")
    for chunk in meshes:
        chunk.hide_render = distance(chunk, eye) > FAR_M
    camera, sideways = stand(eye, ahead)
    left, above = HEADLAMP_M
    shine("headlamp", eye - left * sideways + above * Vector((0, 0, 1)), HEADLAMP_W, 0.04)
    forward, raised = AHEAD_M
    shine("ahead", eye + forward * ahead + raised * Vector((0, 0, 1)), AHEAD_W, 0.15)
    render(camera, picture)
    print(f"picture in {picture}")


def view_of(pose):
    """Eye and direction of a pose, from the Y-up frame of the package to that of Blender."""
    x, y, z, w = pose["rotation"]
    ahead = Quaternion((w, x, y, z)) @ Vector((1, 0, 0))
    right, up, back = pose["position"]
    direction = Vector((ahead.x, -ahead.z, 0)).normalized()
    return Vector((right, -back, up + EYE_M)), direction


def distance(chunk, point):
    corners = [chunk.matrix_world @ Vector(corner) for corner in chunk.bound_box]
    low, high = ([pick(corner[axis] for corner in corners) for axis in range(3)] for pick in (min, max))
    nearest = Vector([min(max(point[axis], low[axis]), high[axis]) for axis in range(3)])
    return (nearest - point).length


def stand(eye, ahead):
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.sensor_width, camera.data.lens, camera.data.clip_start = SENSOR_MM, FOCAL_MM, 0.02
    sideways = ahead.cross(Vector((0, 0, 1)))
    up = sideways.cross(ahead)
    axes = Matrix((sideways, up, -ahead)).transposed()
    camera.matrix_world = Matrix.Translation(eye) @ axes.to_4x4()
    bpy.context.scene.collection.objects.link(camera)
    return camera, sideways


def shine(name, place, watts, radius_m):
    lamp = bpy.data.objects.new(name, bpy.data.lights.new(name, "POINT"))
    lamp.data.energy, lamp.data.shadow_soft_size, lamp.data.color = watts, radius_m, (1.0, 0.94, 0.86)
    lamp.location = place
    bpy.context.scene.collection.objects.link(lamp)


def render(camera, picture):
    scene = bpy.context.scene
    scene.camera = camera
    scene.world = bpy.data.worlds.new("dark")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.0
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.seed, cycles.max_bounces = "CPU", SAMPLES, 1, 3
    cycles.use_adaptive_sampling, cycles.adaptive_threshold = True, 0.02
    cycles.use_denoising, cycles.denoiser = True, "OPENIMAGEDENOISE"
    cycles.denoising_input_passes, cycles.denoising_prefilter = "RGB_ALBEDO_NORMAL", "ACCURATE"
    scene.view_settings.view_transform, scene.view_settings.look = "AgX", "AgX - Medium High Contrast"
    scene.view_settings.exposure = metered(scene)
    scene.render.resolution_x, scene.render.resolution_y = SIZE_PX
    scene.render.filepath = str(picture)
    bpy.ops.render.render(write_still=True)


def metered(scene):
    """The exposure in stops at which a small picture has the mean luminance that a camera aims at."""
    settings = scene.render.image_settings
    scene.render.resolution_x, scene.render.resolution_y = (side // 10 for side in SIZE_PX)
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath, settings.file_format = str(Path(folder) / "metered.exr"), "OPEN_EXR"
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(scene.render.filepath)
        pixels = list(image.pixels)
    settings.file_format, settings.color_mode, settings.quality = "JPEG", "RGB", QUALITY
    colors = zip(pixels[0::4], pixels[1::4], pixels[2::4], strict=True)
    luminances = [0.21 * red + 0.72 * green + 0.07 * blue for red, green, blue in colors]
    # Of the logarithms, so that a highlight does not darken the rest; what no lamp reaches stays dark.
    mean = math.exp(sum(math.log(max(luminance, DARK)) for luminance in luminances) / len(luminances))
    return max(-MOST_STOPS, min(MOST_STOPS, math.log2(MEAN_LUMINANCE / mean)))


def require(condition, message):
    if not condition:
        sys.exit(f"error: {message}")


if __name__ == "__main__":
    require(len(sys.argv) == 4, "usage: picture.py PACKAGE_DIR PICTURE.jpg SPAWN")
    main(Path(os.path.abspath(sys.argv[1])), Path(os.path.abspath(sys.argv[2])), int(sys.argv[3]))
    sys.stdout.flush()
    # Blender may crash when it frees a scene with many copies, after the picture is written.
    os._exit(0)
