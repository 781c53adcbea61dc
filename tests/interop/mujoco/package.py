"""A MuJoCo package as the checks see it.

The wall that everything is held to is the visual mesh, as its files have it, in the hands of trimesh: MuJoCo's own geometry has
no part in it.
"""

import sys
from pathlib import Path

import mujoco
import numpy as np
import trimesh
from trimesh.proximity import closest_point
from trimesh.ray.ray_util import contains_points

COLLISION_GROUP = 3
# How far the surface of convex pieces may be from the visual mesh, before or behind it, by default; metres.
TOLERANCE_M = {"floor": 0.02, "wall": 0.05, "ceiling": 0.05}
# Kinds of things with an open mouth, which their convex hull closes: docs/limits.md says so.
HOLLOW = ("duct",)
# Rays that miss an edge between two triangles, or a second wall close behind the first, tell inside from outside wrongly for 5 of
# 1000 points, and which ones depends on the processor: the majority of many directions decides.
DIRECTIONS = np.random.default_rng(1).normal(size=(15, 3))


class Failure(Exception):
    """What is wrong with a package."""


def require(truth, message):
    if not truth:
        raise Failure(message)


def name_of(package):
    """The name of the cave: `<name>.xml` is the cave alone, `<name>_rover.xml` has the rover in it."""
    names = [file.name.removesuffix("_rover.xml") for file in package.glob("*_rover.xml")]
    names = [name for name in names if (package / f"{name}.xml").is_file()]
    require(len(names) == 1, f"expected one cave with a rover in {package.name}, found {names}")
    return names[0]


def cave_spec(package):
    """The cave alone, to be edited."""
    return mujoco.MjSpec.from_file(str(package / f"{name_of(package)}.xml"))


def tolerances_m(model, spec):
    """The tolerance of each geom of a model, by the class it has in the package; 0 where it is none of the rock."""
    classes = {geom.name: geom.classname.name for geom in spec.geoms}
    zones = [classes[model.geom(geom).name].rpartition("_")[2] for geom in range(model.ngeom)]
    return np.array([TOLERANCE_M.get(zone, 0.0) for zone in zones])


class Wall:
    """The wall of a cave: triangles that face the open."""

    def __init__(self, package):
        spec, name = cave_spec(package), name_of(package)
        drawn = {geom.meshname for geom in spec.geoms if geom.classname.name == f"{name}_visual"}
        meshes = {mesh.name: mesh for mesh in spec.meshes if mesh.name in drawn}
        require(meshes, "the package has no visual mesh")
        files = {file: read_msh(file) for file in {package / spec.meshdir / mesh.file for mesh in meshes.values()}}
        chunks, things = [], []
        seen = [geom for geom in spec.geoms if geom.classname.name == f"{name}_visual"]
        # Nothing collides with gravel.
        for geom in [geom for geom in seen if not geom.name.startswith(f"{name}_gravel_")]:
            asset = meshes[geom.meshname]
            shape = placed(files[package / spec.meshdir / asset.file], asset, geom)
            if geom.name.startswith(tuple(f"{name}_{kind}_" for kind in HOLLOW)):
                shape = shape.convex_hull
            # A chunk has a mesh of its own.
            (chunks if geom.name == geom.meshname else things).append(shape)
        wall = trimesh.util.concatenate(chunks)
        wall.merge_vertices()
        self.mesh = trimesh.util.concatenate([wall, *things])
        require(self.mesh.is_watertight, "the visual mesh is not closed")
        require(self.mesh.volume < 0, "the visual mesh faces the rock")

    @property
    def bounds(self):
        return self.mesh.bounds

    def nearest(self, points):
        """The nearest point of the wall, and how far it is: positive from the open, negative from the rock."""
        places, distances_m, _ = closest_point(self.mesh, points)
        return places, np.where(self.contains(points), distances_m, -distances_m)

    def contains(self, points):
        """Which points are in the open."""
        votes = [contains_points(self.mesh.ray, points, check_direction=direction) for direction in DIRECTIONS]
        return np.sum(votes, axis=0) > len(DIRECTIONS) / 2

    def is_beyond(self, points, open_m, slack_m):
        """Which points, so far in the open, are further from floors and from steeper parts of the wall than their tolerances."""
        beyond = open_m > TOLERANCE_M["floor"] + slack_m
        if beyond.any():
            steep = self.mesh.submesh([np.flatnonzero(self.mesh.face_normals[:, 2] <= np.sqrt(0.5))], append=True)
            _, distances_m, _ = closest_point(steep, points[beyond])
            beyond[beyond] = distances_m > TOLERANCE_M["wall"] + slack_m
        return beyond

    def free_points(self, count, clearance_m, dice):
        """Points in the open, this far from the wall at least, spread evenly over the volume."""
        found = np.empty((0, 3))
        while len(found) < count:
            points = dice.uniform(*self.bounds, (4 * count, 3))
            points = points[self.contains(points)]
            found = np.concatenate([found, points[self.nearest(points)[1] >= clearance_m]])
        return found[:count]

    def first_hits_m(self, points, directions):
        """How far rays go to the wall; infinity where there is none."""
        along_m = np.full(len(points), np.inf)
        places, rays, _ = self.mesh.ray.intersects_location(points, directions, multiple_hits=False)
        along_m[rays] = np.linalg.norm(places - points[rays], axis=1)
        return along_m


def placed(mesh, asset, geom):
    """A mesh of a file in the size of its asset and at the place of its geom, or of the body of that."""
    turned = mesh.vertices * asset.scale
    for pose in [geom] if geom.parent.name == "world" else [geom, geom.parent]:
        turn = np.zeros(9)
        mujoco.mju_quat2Mat(turn, pose.quat)
        turned = turned @ turn.reshape(3, 3).T + pose.pos
    return trimesh.Trimesh(turned, mesh.faces, process=False)


def read_msh(file):
    """The triangles of a mesh in MuJoCo's own format: four counts, then vertices, normals, texture coordinates, faces."""
    content = file.read_bytes()
    vertices, normals, coordinates, faces = np.frombuffer(content, "<i4", 4)
    positions = np.frombuffer(content, "<f4", 3 * vertices, 16).reshape(-1, 3)
    before = 16 + 4 * (3 * vertices + 3 * normals + 2 * coordinates)
    corners = np.frombuffer(content, "<i4", 3 * faces, before).reshape(-1, 3)
    mesh = trimesh.Trimesh(positions, corners, process=False)
    # Before it is turned, since then the sides of a seam may differ in the last bit.
    mesh.merge_vertices()
    return mesh


def run(verify):
    """Runs a check on the package that the command line names; its summary goes to stdout, failures to stderr."""
    try:
        print(verify(Path(sys.argv[1]), *map(Path, sys.argv[2:])))
    except (Failure, ValueError) as failure:
        sys.exit(str(failure))
