"""A USD package as the checks see it."""

import sys
from pathlib import Path

import numpy as np
from pxr import Tf, Usd, UsdGeom


class Failure(Exception):
    """What is wrong with a package."""


def require(truth, message):
    if not truth:
        raise Failure(message)


def root_layer(package):
    """The one layer of the package that a user opens."""
    found = sorted([*package.glob("*.usda"), *package.glob("*.usdz")])
    require(len(found) == 1, f"expected one .usda or .usdz in {package.name}, found {[file.name for file in found]}")
    return found[0]


def open_stage(path, load=Usd.Stage.LoadAll):
    return Usd.Stage.Open(str(path), load)


def meshes(stage, name):
    """Every mesh prim with this name."""
    return [UsdGeom.Mesh(prim) for prim in stage.TraverseAll() if prim.IsA(UsdGeom.Mesh) and prim.GetName() == name]


def colliders(stage):
    """Every mesh that bodies touch: the collision mesh of each chunk, or its convex pieces."""
    found = [UsdGeom.Mesh(prim) for prim in stage.TraverseAll() if prim.IsA(UsdGeom.Mesh)]
    return [mesh for mesh in found if "Collision" in str(mesh.GetPath()).split("/")]


def chunks(stage):
    return stage.GetPrimAtPath("/World/Chunks").GetAllChildren()


def levels_of(chunk):
    """Selects each level of detail of a chunk in turn, in the session layer and not in the package."""
    levels = chunk.GetVariantSet("LOD")
    stage = chunk.GetStage()
    for level in levels.GetVariantNames():
        with Usd.EditContext(stage, stage.GetSessionLayer()):
            levels.SetVariantSelection(level)
        yield level


def triangles(mesh):
    """Corners in metres, shape (triangle, corner, xyz)."""
    points = np.asarray(mesh.GetPointsAttr().Get() or [], dtype=np.float64).reshape(-1, 3)
    return points[np.asarray(mesh.GetFaceVertexIndicesAttr().Get() or [], dtype=np.int64).reshape(-1, 3)]


def spawns(stage):
    """Poses, shape (spawn, 4, 4), column vectors."""
    prims = stage.GetPrimAtPath("/World/Spawns").GetChildren()
    cache = UsdGeom.XformCache()
    return np.array([np.asarray(cache.GetLocalToWorldTransform(prim)).T for prim in prims])


def run(verify):
    """Runs a check on the package that the command line names; its summary goes to stdout, failures to stderr."""
    try:
        print(verify(Path(sys.argv[1]), *sys.argv[2:]))
    except (Failure, Tf.ErrorException) as failure:
        sys.exit(str(failure))
