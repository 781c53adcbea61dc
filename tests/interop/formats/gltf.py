"""The marker as glTF, read by trimesh, and by pygltflib for its tangents.

gltf.py SAMPLE_DIR
"""

from pathlib import Path

import numpy as np
import pygltflib
from packages import Z_UP_FROM_Y_UP, Reader, Triangles, is_drawn, joined, require, upper_left

TYPES = {5121: "<u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


def by_pygltflib(path):
    document = pygltflib.GLTF2().load(str(path))
    parts = [part for node in document.nodes if is_mesh(node) for part in primitives(document, node, path)]
    return joined(parts).turned(Z_UP_FROM_Y_UP)


def is_mesh(node):
    return node.mesh is not None and is_drawn(node.name)


def primitives(document, node, path):
    require(not (node.matrix or node.translation or node.rotation or node.scale), "a node is moved")
    for primitive in document.meshes[node.mesh].primitives:
        names = primitive.attributes
        rows = [names.POSITION, names.NORMAL, names.TEXCOORD_0, names.TANGENT]
        position, normal, uv, tangent = (numbers(document, accessor, path) for accessor in rows)
        yield Triangles.of_mesh(numbers(document, primitive.indices, path), position, normal, upper_left(uv), tangent)


def numbers(document, index, path):
    accessor = document.accessors[index]
    view = document.bufferViews[accessor.bufferView]
    uri = document.buffers[view.buffer].uri
    data = (Path(path).parent / uri).read_bytes() if uri else document.binary_blob()
    start, width = (view.byteOffset or 0) + (accessor.byteOffset or 0), WIDTHS[accessor.type]
    kind = np.dtype(TYPES[accessor.componentType])
    require(view.byteStride in (None, width * kind.itemsize), "attributes are interleaved")
    read = np.frombuffer(data, kind, accessor.count * width, start)
    return read.reshape(-1, width) if width > 1 else read


READERS = [Reader("pygltflib", by_pygltflib, {"*": ["**/*.glb", "**/*.gltf"], "tiles": []})]
