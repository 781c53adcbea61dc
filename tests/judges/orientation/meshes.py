"""The marker as OBJ, PLY and STL, and as the OBJ that SDF and URDF name, read by trimesh, plyfile and numpy-stl.

meshes.py SAMPLE_DIR
"""

from xml.etree import ElementTree

import numpy as np
import plyfile
import stl
import trimesh
from truth import Triangles, joined, require, run


def by_trimesh(path):
    loaded = trimesh.load(path, process=False)
    meshes = loaded.geometry.values() if isinstance(loaded, trimesh.Scene) else [loaded]
    return joined(map(of_trimesh, meshes))


def of_trimesh(mesh):
    # Normals that are not in the file would be made up.
    normal = mesh.vertex_normals if "vertex_normals" in mesh._cache else None
    uv = getattr(mesh.visual, "uv", None)
    return Triangles.of_mesh(mesh.faces, mesh.vertices, normal, uv)


def by_plyfile(path):
    data = plyfile.PlyData.read(path)
    vertex = data["vertex"]

    def columns(*names):
        return np.column_stack([vertex[name] for name in names])

    faces = np.vstack(data["face"]["vertex_indices"])
    return Triangles.of_mesh(faces, columns("x", "y", "z"), columns("nx", "ny", "nz"), columns("s", "t"))


def by_numpy_stl(path):
    """Normals of STL say the same as the order of the corners, or it is no STL."""
    solid = stl.mesh.Mesh.from_file(str(path), calculate_normals=False)
    said, made = solid.normals.copy(), Triangles(solid.vectors.astype(np.float64))
    solid.update_normals()
    unit = solid.normals / np.linalg.norm(solid.normals, axis=1, keepdims=True)
    require(np.allclose(said, unit, atol=1e-5), "normals of triangles are not those of their corners")
    return made


def of_sdf(path):
    uris = [uri.text for uri in ElementTree.parse(path).iterfind(".//visual/geometry/mesh/uri")]
    return named(path.parent.parent, uris)


def of_urdf(path):
    meshes = ElementTree.parse(path).iterfind(".//visual/geometry/mesh")
    return named(path.parent.parent.parent, [mesh.attrib["filename"] for mesh in meshes])


def named(folder, uris):
    """The files that URIs name, below the folder in which the package lies."""
    require(uris, "no visual mesh is named")
    return joined(by_trimesh(folder / uri.split("://")[1]) for uri in uris)


if __name__ == "__main__":
    run(
        {
            "trimesh": (by_trimesh, {"obj": ["marker.obj"], "ply": ["*.ply"], "stl": ["*.stl"]}),
            "trimesh through SDF": (of_sdf, {"gazebo": ["models/*/model.sdf"]}),
            "trimesh through URDF": (of_urdf, {"urdf": ["*/urdf/*.urdf"]}),
            "plyfile": (by_plyfile, {"ply": ["*.ply"]}),
            "numpy-stl": (by_numpy_stl, {"stl": ["*.stl"]}),
        }
    )
