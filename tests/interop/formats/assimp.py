"""FBX, OBJ, glTF, PLY and STL, read by assimp: the marker, or all packages of one cave.

    assimp.py SAMPLE_DIR|CAVE_PACKAGES_DIR

assimp turns nothing: glTF is Y up, and of FBX it tells the axes and the unit that the file has.
"""

import sys
from pathlib import Path

import marker
import numpy as np
from impasse import load
from impasse.constants import ProcessingStep
from packages import Z_UP_FROM_Y_UP, Reader, Triangles, is_drawn, joined, require, run

import cave

Y_UP = {".glb", ".gltf"}
MESHES = [f"**/*{ending}" for ending in (".fbx", ".glb", ".gltf", ".ply", ".stl")]
NAME, COLOR_IMAGE = ("?mat.name", 0), ("$tex.file", 1)
FILES = {"*": MESHES, "obj": ["**/*.obj"], "gazebo": [], "urdf": []}


def by_assimp(path):
    scene = open_scene(path)
    made = joined(triangles(mesh, place) for mesh, place in meshes(scene))
    if path.suffix == ".stl":
        made.normal = None  # they are those of the triangles
    return made.turned(Z_UP_FROM_Y_UP) if path.suffix in Y_UP else in_axes(made, scene.metadata or {})


def open_scene(path):
    return load(str(path), processing=ProcessingStep.Triangulate)


def in_axes(made, told):
    """From the axes of an FBX: to the right is x, up is z, and away from who looks is y."""
    if "UpAxis" not in told:
        return made
    right, up, front = (np.eye(3)[told[axis]] * told[f"{axis}Sign"] for axis in ("CoordAxis", "UpAxis", "FrontAxis"))
    made.position = made.position * told["UnitScaleFactor"] / 100  # centimetres are the unit of FBX
    return made.turned([right, -front, up])


def meshes(scene):
    """What is drawn, each with its place in the scene of the file."""
    yield from below(scene.root_node, np.eye(4))


def below(node, world_from_parent):
    world_from_node = world_from_parent @ np.array(node.transformation)
    for mesh in node.meshes:
        if is_drawn(mesh.name) and is_drawn(node.name):
            yield mesh, world_from_node
    for child in node.children:
        yield from below(child, world_from_node)


def triangles(mesh, world_from_mesh):
    turn = world_from_mesh[:3, :3]

    def turned(vectors):
        return np.array(vectors) @ turn.T if len(vectors) else None

    normals, along, across = turned(mesh.normals), turned(mesh.tangents), turned(mesh.bitangents)
    tangents = None
    if along is not None and across is not None:
        hand = np.sign(np.einsum("ij,ij->i", np.cross(normals, along), across))
        tangents = np.column_stack([along, hand])
    uv = np.array(mesh.texture_coords[0])[:, :2] if mesh.texture_coords and mesh.texture_coords[0] is not None else None
    points = turned(mesh.vertices) + world_from_mesh[:3, 3]
    return Triangles.of_mesh(np.array(mesh.faces), points, normals, uv, tangents)


def materials(path):
    """Number of materials; each has an image of its colour, next to the file or in it."""
    if path.suffix in (".ply", ".stl"):
        return None
    found = {}
    for mesh, _ in meshes(open_scene(path)):
        properties = dict(mesh.material)
        name, image = properties[NAME], properties.get(COLOR_IMAGE)
        require(image, f"{path.name}: material {name} has no image")
        require(image.startswith("*") or (path.parent / image).is_file(), f"{path.name}: {image} is not there")
        found[name] = image
    return len(found)


if __name__ == "__main__":
    is_marker = (Path(sys.argv[1]) / "marker").is_dir()
    run(marker.verify if is_marker else cave.verify, [Reader("assimp", by_assimp, FILES, materials)])
