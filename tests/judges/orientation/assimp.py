"""The marker as FBX, OBJ, glTF, PLY and STL, read by assimp.

    assimp.py SAMPLE_DIR

assimp turns glTF nowhere, and says of FBX which axes it has; OBJ, PLY and STL arrive as they are.
"""

import numpy as np
from impasse import load
from impasse.constants import ProcessingStep
from truth import Z_UP_FROM_Y_UP, Triangles, joined, run

Y_UP = {".glb", ".gltf"}


def by_assimp(path):
    scene = load(str(path), processing=ProcessingStep.Triangulate)
    made = joined(parts(scene, scene.root_node, np.eye(4)))
    if path.suffix == ".stl":
        made.normal = None  # they are those of the triangles
    return made.turned(Z_UP_FROM_Y_UP) if path.suffix in Y_UP else made


def parts(scene, node, world_from_parent):
    world_from_node = world_from_parent @ np.array(node.transformation)
    for mesh in node.meshes:
        if not is_collision(mesh.name) and not is_collision(node.name):
            yield triangles(mesh, world_from_node)
    for child in node.children:
        yield from parts(scene, child, world_from_node)


def is_collision(name):
    return name.startswith("UCX_") or "collision" in name.lower()


def triangles(mesh, world_from_mesh):
    turn = world_from_mesh[:3, :3]
    points = np.array(mesh.vertices) @ turn.T + world_from_mesh[:3, 3]
    normals = np.array(mesh.normals) @ turn.T if len(mesh.normals) else None
    uv = np.array(mesh.texture_coords[0])[:, :2] if mesh.texture_coords and mesh.texture_coords[0] is not None else None
    return Triangles.of_mesh(np.array(mesh.faces), points, normals, uv)


if __name__ == "__main__":
    MESHES = [f"**/*{ending}" for ending in (".fbx", ".glb", ".gltf", ".ply", ".stl")]
    run({"assimp": (by_assimp, {"*": MESHES, "obj": ["marker.obj"], "gazebo": [], "urdf": []})})
