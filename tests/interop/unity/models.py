"""The FBX of a package, read by assimp, and what Unity's importer makes of them."""

import assimp_py
import numpy as np
import xxhash
from documents import Failure, require


def mesh_id(name):
    """The number of a mesh in a model: the signed xxHash64 of its class, its name and how many of that name come before."""
    number = xxhash.xxh64(f"Type:Mesh->{name}0".encode()).intdigest()
    return number - (1 << 64) if number >> 63 else number


# Unity itself has given these: the mesh of an OBJ, and that of Blender's first scene.
assert mesh_id("default") == -2432090755550338912
assert mesh_id("Cube") == -5495902117074765545


class Model:
    """Meshes by their number, in Unity's frame: x is turned round, and the order of corners with it."""

    def __init__(self, path):
        self.path = path
        try:
            scene = assimp_py.import_file(str(path), assimp_py.Process_Triangulate)
        except RuntimeError as error:
            raise Failure(f"assimp cannot read {path.name}: {error}") from error
        self.materials = [material["NAME"] for material in scene.materials]
        self.meshes = {}
        for node in below(scene.root_node):
            require(
                np.array_equal(node.transformation, np.eye(4)), f"{path.name}: node {node.name} is not at the origin"
            )
            for mesh in (scene.meshes[index] for index in node.mesh_indices):
                require(node.name == mesh.name, f"{path.name}: node {node.name} has a mesh called {mesh.name}")
                require(mesh_id(mesh.name) not in self.meshes, f"{path.name} has two meshes called {mesh.name}")
                self.meshes[mesh_id(mesh.name)] = Mesh(mesh, self.materials)


def below(node):
    yield node
    for child in node.children:
        yield from below(child)


class Mesh:
    def __init__(self, mesh, materials):
        self.name = mesh.name
        self.points = np.array(mesh.vertices, dtype=np.float64).reshape(-1, 3) * [-1, 1, 1]
        self.faces = np.array(mesh.indices).reshape(-1, 3)[:, [0, 2, 1]]
        self.material = materials[mesh.material_index]
        self.is_seen = mesh.normals is not None and bool(mesh.texcoords)


def distances(points, faces, origin, axis, sign):
    """How far along an axis the triangles are from a point, in metres: one number for each that is met."""
    across = [other for other in range(3) if other != axis]
    flat = points[:, across] - np.array(origin)[across]
    corners = flat[faces]
    near = (corners.min(axis=1) <= 0).all(axis=1) & (corners.max(axis=1) >= 0).all(axis=1)
    corners, heights = corners[near], points[faces[near], axis]

    def area(a, b):
        return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]

    parts = np.stack([area(corners[:, k - 2], corners[:, k - 1]) for k in range(3)], axis=1)
    whole = parts.sum(axis=1)
    inside = ((parts >= 0).all(axis=1) | (parts <= 0).all(axis=1)) & (whole != 0)
    met = (parts[inside] * heights[inside]).sum(axis=1) / whole[inside]
    along = sign * (met - origin[axis])
    return along[along >= 0]
