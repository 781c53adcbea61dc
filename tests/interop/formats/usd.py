"""The marker as USD, read by usd-core.

usd.py SAMPLE_DIR
"""

import numpy as np
from packages import Reader, Triangles, joined, require
from pxr import Usd, UsdGeom


def by_usd_core(path):
    stage = Usd.Stage.Open(str(path))
    require(UsdGeom.GetStageUpAxis(stage) == "Z", "Z is not up")
    scale = UsdGeom.GetStageMetersPerUnit(stage)
    places = UsdGeom.XformCache()
    meshes = [UsdGeom.Mesh(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)]
    drawn = [mesh for mesh in meshes if mesh.ComputePurpose() == UsdGeom.Tokens.default_]
    return joined(triangles(mesh, np.array(places.GetLocalToWorldTransform(mesh.GetPrim())), scale) for mesh in drawn)


def triangles(mesh, world_from_mesh, scale):
    """USD matrices multiply row vectors from the right."""
    require(set(mesh.GetFaceVertexCountsAttr().Get()) == {3}, "there are faces with more than three corners")
    faces = np.array(mesh.GetFaceVertexIndicesAttr().Get()).reshape(-1, 3)
    if mesh.GetOrientationAttr().Get() == UsdGeom.Tokens.leftHanded:
        faces = faces[:, ::-1]
    points = np.array(mesh.GetPointsAttr().Get()) @ world_from_mesh[:3, :3] + world_from_mesh[3, :3]
    normals = np.array(mesh.GetNormalsAttr().Get()) @ world_from_mesh[:3, :3]
    uv = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("st").ComputeFlattened()
    return Triangles.of_mesh(faces, scale * points, normals, uv)


READERS = [Reader("usd-core", by_usd_core, {"*": ["*.usd", "*.usda", "*.usdz"]})]
