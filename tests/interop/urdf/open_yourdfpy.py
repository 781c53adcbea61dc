"""Opens a URDF package with yourdfpy and trimesh, and its package.xml with the reader of the ROS build tools.

    open_yourdfpy.py PACKAGE_DIR

All triangles of all collision meshes must arrive, and an image on each visual mesh.
"""

import numpy as np
import yourdfpy
from catkin_pkg.package import InvalidPackage, parse_package
from package import Failure, Obj, require, run, urdf_of

TOLERANCE_M = 1e-5


def verify(package):
    urdf = urdf_of(package)
    check_ros_package(urdf.parent.parent)
    try:
        world = yourdfpy.URDF.load(str(urdf), load_collision_meshes=True, build_collision_scene_graph=True)
    except (OSError, ValueError) as reason:
        raise Failure(f"yourdfpy cannot load it: {reason}") from reason
    require(world.validate(), f"yourdfpy finds faults: {world.errors}")
    meshes = urdf.parent.parent / "meshes"
    rock = [Obj(path) for path in meshes.glob("*_collision.obj")]
    collision = world.collision_scene.to_geometry()
    wanted = sum(mesh.triangles for mesh in rock)
    require(len(collision.faces) == wanted, f"trimesh has {len(collision.faces)} of {wanted} triangles to touch")
    held = [np.min([mesh.bounds[0] for mesh in rock], axis=0), np.max([mesh.bounds[1] for mesh in rock], axis=0)]
    require(np.allclose(collision.bounds, held, rtol=0, atol=TOLERANCE_M), f"its bounds are {collision.bounds}")
    bare = [name for name, mesh in world.scene.geometry.items() if mesh.visual.material.image is None]
    require(not bare, f"no image is on {bare}")
    return f"yourdfpy: {len(world.scene.geometry)} meshes with images, {wanted} triangles to touch"


def check_ros_package(folder):
    warnings = []
    try:
        description = parse_package(str(folder), warnings=warnings)
        description.validate(warnings=warnings)
    except InvalidPackage as fault:
        raise Failure(f"the ROS build tools refuse package.xml: {fault}") from fault
    require(not warnings, f"the ROS build tools warn of package.xml: {warnings}")
    require(description.name == folder.name, f"package {description.name} lies in {folder.name}")


if __name__ == "__main__":
    run(verify)
