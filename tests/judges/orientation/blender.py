"""The marker in every format that Blender imports, read by Blender as a Python module.

    blender.py SAMPLE_DIR

Blender is Z up and brings every format there by itself, but for OBJ, PLY and STL, which name no axes: it is told, as the
README of the packages tells a human.
"""

import bpy
import numpy as np
from truth import Triangles, joined, run

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


def by_blender(path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    IMPORTS[path.suffix](str(path))
    meshes = [thing for thing in bpy.data.objects if thing.type == "MESH"]
    return joined(triangles(thing) for thing in meshes if not is_collision(thing.name))


def is_collision(name):
    return name.startswith("UCX_") or "collision" in name.lower()


def triangles(thing):
    mesh, world_from_mesh = thing.data, np.array(thing.matrix_world)
    mesh.calc_loop_triangles()
    loops = np.array([triangle.loops for triangle in mesh.loop_triangles])
    points = np.array([mesh.vertices[loop.vertex_index].co for loop in mesh.loops])
    points = points @ world_from_mesh[:3, :3].T + world_from_mesh[:3, 3]
    normals = np.array([corner.vector for corner in mesh.corner_normals]) @ world_from_mesh[:3, :3].T
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    uv = np.array([row.vector for row in mesh.uv_layers.active.uv]) if mesh.uv_layers else None
    # Without normals in the file, those of Blender follow the winding.
    return Triangles.of_mesh(loops, points, normals if mesh.has_custom_normals else None, uv)


if __name__ == "__main__":
    OWN_FOLDERS = {"obj": ["marker.obj"], "gazebo": [], "urdf": []}
    LAYERS = ["*.usd", "*.usda", "*.usdz"]
    OTHERS = [f"**/*{ending}" for ending in (".fbx", ".glb", ".gltf", ".ply", ".stl")]
    run({"Blender": (by_blender, {"*": LAYERS + OTHERS, **OWN_FOLDERS})})
