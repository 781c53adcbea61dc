"""Holds the certificate of a drone to the triangles with which robots collide.

    drone.py PACKAGE_DIR CERTIFICATE.json

libigl measures how far the collision meshes of a Gazebo package are from every pose of every path that is called go: none is
nearer than the radius of the drone.
"""

import json
import sys
from pathlib import Path

import igl
import numpy as np

sys.path.append(str(Path(__file__).parents[1]))
from drop_pybullet import read_collisions, read_world  # noqa: E402
from paths import poses_called_go  # noqa: E402


def main(package, file):
    certificate = json.loads(file.read_text(encoding="utf-8"))
    radius_m = certificate["robot"]["settings"]["radius_m"]
    points = poses_called_go(certificate)[:, :3]
    corners, triangles = triangles_of(package)
    distances_m = np.sqrt(igl.point_mesh_squared_distance(points, corners, triangles)[0])
    near = np.flatnonzero(distances_m < radius_m)
    if len(near):
        worst = near[distances_m[near].argmin()]
        where = f"{distances_m[worst]:.3f} m at {points[worst].round(2).tolist()}"
        sys.exit(f"{len(near)} of {len(points)} poses are nearer to rock than {radius_m} m, the nearest {where}")
    print(f"drone: {len(points)} poses that are called go are {distances_m.min():.3f} m from rock at least")


def triangles_of(package):
    """Corners and triangles of all collision meshes."""
    _, model = read_world(package)
    corners, triangles = [], []
    for file, _ in read_collisions(model, package):
        some, faces = read_obj(file)
        triangles.append(faces + sum(map(len, corners)))
        corners.append(some)
    return np.concatenate(corners), np.concatenate(triangles)


def read_obj(file):
    lines = [line.split() for line in file.read_text(encoding="utf-8").splitlines()]
    corners = np.array([line[1:4] for line in lines if line and line[0] == "v"], dtype=float)
    faces = [[int(corner.split("/")[0]) - 1 for corner in line[1:4]] for line in lines if line and line[0] == "f"]
    return corners, np.array(faces)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
