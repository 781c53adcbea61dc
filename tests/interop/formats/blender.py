"""Every format that Blender imports, read by Blender as a Python module: the marker, or all packages of one cave.

    blender.py SAMPLE_DIR|CAVE_PACKAGES_DIR

Blender is Z up and brings every format there by itself, but for OBJ, PLY and STL, which name no axes: it is told, as the
README of the packages tells a human. Of a cave it must find a material per chunk, whose images are there, colours as sRGB and
all else as numbers. Of MTL it reads no `norm`, and `map_Pr` as sRGB, which are faults of its importer: there is no key that
could tell it.
"""

import sys
from pathlib import Path

import bpy
import marker
import numpy as np
from packages import Reader, Triangles, is_drawn, joined, require, run

import cave

TOLD = {"forward_axis": "Y", "up_axis": "Z"}
IMPORTS = {
    ".fbx": lambda path: bpy.ops.import_scene.fbx(filepath=path),
    ".glb": lambda path: bpy.ops.import_scene.gltf(filepath=path),
    ".gltf": lambda path: bpy.ops.import_scene.gltf(filepath=path),
    ".obj": lambda path: bpy.ops.wm.obj_import(filepath=path, **TOLD),
    ".ply": lambda path: bpy.ops.wm.ply_import(filepath=path, **TOLD),
    ".stl": lambda path: bpy.ops.wm.stl_import(filepath=path, **TOLD),
    ".usd": lambda path: bpy.ops.wm.usd_import(filepath=path),
    ".usda": lambda path: bpy.ops.wm.usd_import(filepath=path),
    ".usdz": lambda path: bpy.ops.wm.usd_import(filepath=path),
}
FILES = {
    "gazebo": [],
    "urdf": [],
    "truth": [],
    "tiles": [],
    "obj": ["**/*.obj"],
    "*": ["*.usd", "*.usda", "*.usdz", *(f"**/*{ending}" for ending in (".fbx", ".glb", ".gltf", ".ply", ".stl"))],
}
# What the images behind the inputs of a surface are.
SPACES = {"Base Color": "sRGB", "Normal": "Non-Color", "Roughness": "Non-Color"}
SPACES_OF_OBJ = {"Base Color": "sRGB", "Roughness": "sRGB"}


def by_blender(path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    require("FINISHED" in IMPORTS[path.suffix](str(path)), f"Blender cannot import {path.name}")
    return joined([triangles(thing.data, world_from_mesh) for thing, world_from_mesh in drawn()])


def drawn():
    """The objects of the scene with their places; of instances, each of its copies."""
    found = [
        (instance.object.original, np.array(instance.matrix_world))
        for instance in bpy.context.evaluated_depsgraph_get().object_instances
    ]
    return [(thing, place) for thing, place in found if thing.type == "MESH" and is_drawn(thing.name)]


def triangles(mesh, world_from_mesh):
    mesh.calc_loop_triangles()
    loops = numbers(mesh.loop_triangles, "loops", 3, np.int32)
    points = numbers(mesh.vertices, "co", 3)[numbers(mesh.loops, "vertex_index", 1, np.int32)[:, 0]]
    points = points @ world_from_mesh[:3, :3].T + world_from_mesh[:3, 3]
    normals = numbers(mesh.corner_normals, "vector", 3) @ world_from_mesh[:3, :3].T
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    uv = numbers(mesh.uv_layers.active.uv, "vector", 2) if mesh.uv_layers else None
    # Without normals in the file, those of Blender follow the winding.
    return Triangles.of_mesh(loops, points, normals if mesh.has_custom_normals else None, uv)


def numbers(rows, name, width, kind=np.float32):
    flat = np.empty(len(rows) * width, dtype=kind)
    rows.foreach_get(name, flat)
    return flat.reshape(-1, width)


def materials(path):
    """Number of materials in use that differ; fails if images are missing or have the wrong colour space.

    In USD each prototype of things has a material of its own, all with the same images.
    """
    if path.suffix in (".ply", ".stl"):
        return None
    found = {slot.material for thing, _ in drawn() for slot in thing.material_slots}
    require(None not in found, f"{path.name}: a mesh has no material")
    spaces = SPACES_OF_OBJ if path.suffix == ".obj" else SPACES
    return len({color_image(material, spaces, f"{path.name}: {material.name}") for material in found})


def color_image(material, spaces, where):
    """Checks the images of a material; gives the one of its colour."""
    seen = dict(images(material))
    require(spaces.keys() <= seen.keys(), f"{where} has images for {sorted(seen)} only")
    for name, image in seen.items():
        require(image.size[0] > 0, f"{where}: {image.name} cannot be read")
        space = image.colorspace_settings.name
        require(space == spaces.get(name, "Non-Color"), f"{where}: the image of {name} is taken for {space}")
    return seen["Base Color"]


def images(material):
    """The images connected to the inputs of the surface, through any number of nodes."""
    surface = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    for socket in surface.inputs:
        pending = [link.from_node for link in socket.links]
        while pending:
            node = pending.pop()
            if node.type == "TEX_IMAGE" and node.image:
                yield socket.name, node.image
            pending += [link.from_node for behind in node.inputs for link in behind.links]


if __name__ == "__main__":
    is_marker = (Path(sys.argv[1]) / "marker").is_dir()
    run(marker.verify if is_marker else cave.verify, [Reader("Blender", by_blender, FILES, materials)])
