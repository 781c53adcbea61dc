"""FBX, OBJ, glTF, PLY and STL, read by assimp: the marker, or all packages of one cave.

    assimp.py SAMPLE_DIR|CAVE_PACKAGES_DIR

assimp turns nothing: glTF is Y up, and of FBX it tells the axes and the unit that the file has.
"""

import sys
from ctypes import string_at
from pathlib import Path

import marker
import numpy as np
from impasse import load
from impasse.constants import ProcessingStep
from impasse.structs import ffi
from packages import Z_UP_FROM_Y_UP, Reader, Triangles, is_drawn, joined, require, run

import cave

Y_UP = {".glb", ".gltf"}
MESHES = [f"**/*{ending}" for ending in (".fbx", ".glb", ".gltf", ".ply", ".stl")]
NAME, COLOR_IMAGE = ("?mat.name", 0), ("$tex.file", 1)
FILES = {"*": MESHES, "obj": ["**/*.obj"], "gazebo": [], "urdf": [], "truth": [], "tiles": []}


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
    turn, held = world_from_mesh[:3, :3], mesh.struct

    def turned(pointer):
        return vectors(pointer, held.mNumVertices) @ turn.T if pointer else None

    normals, along, across = turned(held.mNormals), turned(held.mTangents), turned(held.mBitangents)
    tangents = None
    if along is not None and across is not None:
        hand = np.sign(np.einsum("ij,ij->i", np.cross(normals, along), across))
        tangents = np.column_stack([along, hand])
    uv = vectors(held.mTextureCoords[0], held.mNumVertices)[:, :2] if held.mTextureCoords[0] else None
    points = turned(held.mVertices) + world_from_mesh[:3, 3]
    return Triangles.of_mesh(corners(held), points, normals, uv, tangents)


def vectors(pointer, count):
    """An array of assimp's, which impasse would read one number at a time."""
    return np.frombuffer(ffi.buffer(pointer, 12 * count), np.float32).reshape(-1, 3)


def corners(mesh):
    """Every face has a block of memory of its own, and its address in the second half of its 16 bytes."""
    faces = np.frombuffer(ffi.buffer(mesh.mFaces, 16 * mesh.mNumFaces), np.uint64).reshape(-1, 2)
    require((faces[:, 0].astype(np.uint32) == 3).all(), "assimp left a face that is no triangle")
    return np.frombuffer(b"".join(string_at(address, 12) for address in faces[:, 1].tolist()), np.uint32).reshape(-1, 3)


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
