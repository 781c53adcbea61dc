"""OBJ, PLY, STL and glTF, and the OBJ that SDF and URDF name, read by trimesh, plyfile and numpy-stl.

    meshes.py CAVE_PACKAGES_DIR

All packages must be of the same cave. Of OBJ and glTF each material must have its images.
"""

from xml.etree import ElementTree

import labels
import numpy as np
import plyfile
import stl
import trimesh
from packages import Z_UP_FROM_Y_UP, Reader, Triangles, is_drawn, joined, require, run

import cave


def by_trimesh(path):
    scene = trimesh.load_scene(path, process=False)
    parts = []
    for node in scene.graph.nodes_geometry:
        place, name = scene.graph[node]
        if is_drawn(node) and is_drawn(name):
            parts.append(of_trimesh(scene.geometry[name], place))
    is_gltf = path.suffix in (".glb", ".gltf")
    return joined(parts).turned(Z_UP_FROM_Y_UP) if is_gltf else joined(parts)


def of_trimesh(mesh, place):
    points = trimesh.transform_points(mesh.vertices, place)
    # Normals that are not in the file would be made up.
    normals = mesh.vertex_normals @ place[:3, :3].T if "vertex_normals" in mesh._cache else None
    return Triangles.of_mesh(mesh.faces, points, normals, getattr(mesh.visual, "uv", None))


def materials(path):
    """How many there are; each has an image of its colour."""
    if path.suffix in (".ply", ".stl"):
        return None
    meshes = trimesh.load_scene(path, process=False).geometry.values()
    found = {mesh.visual.material.name: mesh.visual.material for mesh in meshes if mesh.visual.defined}
    for material in found.values():
        image = getattr(material, "baseColorTexture", None) or getattr(material, "image", None)
        require(image is not None, f"{path.name}: material {material.name} has no image")
    return len(found)


def by_plyfile(path):
    labels.check(path)
    data = plyfile.PlyData.read(path)
    vertex = data["vertex"]

    def columns(*names):
        return np.column_stack([vertex[name] for name in names])

    faces = np.vstack(data["face"]["vertex_indices"])
    return Triangles.of_mesh(faces, columns("x", "y", "z"), columns("nx", "ny", "nz"), columns("s", "t"))


def by_numpy_stl(path):
    """Normals of STL must agree with the winding."""
    solid = stl.mesh.Mesh.from_file(str(path), calculate_normals=False)
    said, made = solid.normals.copy(), Triangles(solid.vectors.astype(np.float64))
    solid.update_normals()
    unit = solid.normals / np.linalg.norm(solid.normals, axis=1, keepdims=True)
    require(np.allclose(said, unit, atol=1e-3), "normals of triangles are not those of their corners")
    return made


def of_sdf(path):
    """The models that a world includes, and its own."""
    models = path.parent.parent / "models"
    world = ElementTree.parse(path)
    included = [models / uri.text.split("://")[1] / "model.sdf" for uri in world.iterfind(".//include/uri")]
    found = [model for tree in (world, *map(ElementTree.parse, included)) for model in tree.iter("model")]
    return joined(of_visual(models, model, visual) for model in found for visual in model.iterfind("link/visual"))


def of_visual(models, model, visual):
    mesh = visual.find("geometry/mesh")
    made = by_trimesh(models / mesh.findtext("uri").split("://")[1])
    x, y, z, *angles = map(float, model.findtext("pose", "0 0 0 0 0 0").split())
    made = made.turned(trimesh.transformations.euler_matrix(*angles)[:3, :3])
    made.position = made.position * float(mesh.findtext("scale", "1").split()[0]) + [x, y, z]
    return made


def of_urdf(path):
    meshes = ElementTree.parse(path).iterfind(".//visual/geometry/mesh")
    return named(path.parent.parent.parent, [mesh.attrib["filename"] for mesh in meshes])


def named(folder, uris):
    """The files of URIs, below the folder of the package."""
    return joined(by_trimesh(folder / uri.split("://")[1]) for uri in uris)


MESHES = {
    "obj": ["**/*.obj"],
    "ply": ["**/*.ply"],
    "stl": ["**/*.stl"],
    "*": ["**/*.glb", "**/*.gltf"],
    # Things are instances, which this reader does not know.
    "tiles": [],
}
READERS = [
    Reader("trimesh", by_trimesh, MESHES, materials),
    Reader("trimesh through SDF", of_sdf, {"gazebo": ["worlds/*.sdf"]}),
    Reader("trimesh through URDF", of_urdf, {"urdf": ["*/urdf/*.urdf"]}),
    Reader("plyfile", by_plyfile, {"ply": ["**/*.ply"]}),
    Reader("numpy-stl", by_numpy_stl, {"stl": ["**/*.stl"]}),
]

if __name__ == "__main__":
    run(cave.verify, READERS)
