"""Opens what assimp has written, and the GLB of the same cave, with trimesh and pycollada.

    compare.py PACKAGE_DIR

The GLB is that of the package `glb` beside the folder. Triangles, bounds and areas must agree, every chunk must have its
image, and every file that is named must lie in the package.
"""

import re
import sys
from pathlib import Path

import numpy as np
import trimesh

TOLERANCE_M = 1e-4
# How texts of each kind name files.
NAMES = {
    ".dae": r"<init_from>([^<]*\.\w+)</init_from>",
    ".mtl": r"^\s*(?:map_\w+|bump|norm)\s+(\S+)$",
    ".obj": r"^mtllib\s+(\S+)$",
}


def verify(package):
    (path,) = [path for path in package.iterdir() if path.suffix in (".dae", ".obj")]
    (original,) = (package.parent / "glb").glob("*.glb")
    found, wanted = (trimesh.load_scene(file, process=False) for file in (path, original))
    counts = [sum(triangles(scene)) for scene in (found, wanted)]
    require(counts[0] == counts[1], f"it has {counts[0]} triangles, and the GLB {counts[1]}")
    bounds = np.allclose(found.bounds, wanted.bounds, rtol=0, atol=TOLERANCE_M)
    require(bounds, f"its bounds are {found.bounds.tolist()}, and those of the GLB {wanted.bounds.tolist()}")
    areas = [area_m2(scene) for scene in (found, wanted)]
    require(np.isclose(*areas, rtol=TOLERANCE_M), f"its area is {areas[0]} m², and that of the GLB {areas[1]}")
    bare = [name for name, mesh in found.geometry.items() if image_of(mesh.visual.material) is None]
    require(not bare, f"no image is on {bare}")
    names = check_names(package)
    return (
        f"trimesh {trimesh.__version__}: {path.name}, {counts[0]} triangles as in the GLB, {names} names lead to files"
    )


def triangles(scene):
    """The number of triangles of each node, of which several may share a mesh."""
    return [len(scene.geometry[scene.graph[node][1]].faces) for node in scene.graph.nodes_geometry]


def area_m2(scene):
    """The area of all nodes in their sizes: trimesh's own sum takes each mesh in its own size."""
    placed = [scene.graph[node] for node in scene.graph.nodes_geometry]
    return sum(scene.geometry[mesh].area * np.linalg.det(world[:3, :3]) ** (2 / 3) for world, mesh in placed)


def image_of(material):
    """The image of the base colour, whichever model the reader has made of the material."""
    return material.baseColorTexture if hasattr(material, "baseColorTexture") else material.image


def check_names(package):
    """Number of files referenced by texts of the package; each must be in it."""
    texts = [path for path in package.iterdir() if path.suffix in NAMES]
    names = [name for path in texts for name in re.findall(NAMES[path.suffix], path.read_text(), re.MULTILINE)]
    lost = [name for name in names if not (package / name).is_file()]
    require(names and not lost, f"these names lead nowhere: {lost}")
    return len(names)


class Failure(Exception):
    pass


def require(holds, message):
    if not holds:
        raise Failure(message)


if __name__ == "__main__":
    try:
        print(verify(Path(sys.argv[1])))
    except Failure as failure:
        sys.exit(f"error: {failure}")
