"""Opens every mesh of a URDF package with pinocchio, which must find in it what the OBJ holds.

    open_pinocchio.py PACKAGE_DIR

Bounds are compared to a hundredth of a millimetre, triangles by number. Materials are not checked.
"""

import numpy as np
import pinocchio
from package import Failure, Obj, require, run, urdf_of

TOLERANCE_M = 1e-5  # a float near 100 m


def verify(package):
    urdf = urdf_of(package)
    try:
        model, *kinds = pinocchio.buildModelsFromUrdf(str(urdf), package_dirs=[str(package)])
    except (RuntimeError, ValueError) as reason:
        raise Failure(f"pinocchio cannot open it: {reason}") from reason
    starts = [frame.name for frame in model.frames if frame.name.startswith(f"{urdf.stem}_spawn_")]
    require(model.njoints == 1, f"the world has {model.njoints - 1} joints that move")
    require(starts, "there is no frame for a start pose")
    counts = [sum(check(thing) for thing in kind.geometryObjects) for kind in kinds]
    files = {thing.meshPath for kind in kinds for thing in kind.geometryObjects}
    strays = {str(path) for path in package.glob("*/meshes/*.obj")} - files
    require(not strays, f"nothing names {sorted(strays)}")
    return f"pinocchio: {len(files)} meshes, {counts[0]} triangles to touch, {counts[1]} to see, {len(starts) // 2} start frames"


def check(thing):
    """Holds a geometry to its file; gives its number of triangles."""
    held, mesh = Obj(thing.meshPath), thing.geometry
    require(
        mesh.num_tris == held.triangles, f"{thing.meshPath}: {mesh.num_tris} of {held.triangles} triangles are seen"
    )
    mesh.computeLocalAABB()
    placed = [thing.placement.act(np.array(corner)) for corner in (mesh.aabb_local.min_, mesh.aabb_local.max_)]
    require(np.allclose(placed, held.bounds, rtol=0, atol=TOLERANCE_M), f"{thing.meshPath}: its bounds are {placed}")
    return mesh.num_tris


if __name__ == "__main__":
    run(verify)
