"""Shoots rays through a cave in MuJoCo and compares where they end with the visual mesh.

    rays.py PACKAGE_DIR

Bodies collide with the convex hull of a mesh, rays with its triangles: so first every collision mesh must be convex.

Rays go from random points in the open in random directions. All must end. There the collision geometry must not stand further
out of the visual mesh than the tolerance (2 cm from what is less steep than 45 degrees, or 5 cm from what is not). Nor may it
lie further behind it than half of the larger, which is how far behind the wall pieces begin. A ray that grazes a wall may well end far from
where the visual mesh stops it, so it is the distance of its end to the visual mesh that counts. The last line of a success tells
both.
"""

import mujoco
import numpy as np
from package import COLLISION_GROUP, TOLERANCE_M, Wall, cave_spec, require, run

POINTS = 200
RAYS = 50  # from each point
SEED = 2
CLEARANCE_M = 0.06  # beyond any tolerance: no ray starts in a piece
SLACK_M = 0.001
SLIVER_M = 1e-4  # a triangle that is less wide faces anywhere


def verify(package):
    wall, dice = Wall(package), np.random.default_rng(SEED)
    points = wall.free_points(POINTS, CLEARANCE_M, dice)
    directions = dice.normal(size=(POINTS, RAYS, 3))
    directions /= np.linalg.norm(directions, axis=2, keepdims=True)
    spec = cave_spec(package)
    model = spec.compile()
    check_convex(model)
    along_m = shoot(model, points, directions).ravel()
    starts, directions = np.repeat(points, RAYS, axis=0), directions.reshape(-1, 3)
    lost = along_m < 0
    require(
        not lost.any(),
        f"{lost.sum()} of {len(along_m)} rays leave the cave, the first from {starts[lost][:1].round(2)}",
    )

    ends = starts + along_m[:, None] * directions
    _, open_m = wall.nearest(ends)
    out, behind = wall.is_beyond(ends, open_m, SLACK_M), -open_m > max(TOLERANCE_M.values()) / 2 + SLACK_M
    require(not out.any(), f"{out.sum()} of {len(ends)} rays end in the open, up to {open_m.max():.3f} m from the wall")
    require(
        not behind.any(), f"{behind.sum()} of {len(ends)} rays end behind the wall, up to {-open_m.min():.3f} m from it"
    )
    differences_m = np.abs(along_m - wall.first_hits_m(starts, directions))
    middle, most = np.percentile(differences_m, [50, 99]) * 1000
    return (
        f"MuJoCo: {len(ends)} rays end from {-open_m.min() * 1000:.1f} mm behind to {open_m.max() * 1000:.1f} mm before the "
        f"visual mesh; along the ray they differ by {middle:.1f} mm (half of them), {most:.1f} mm (99 of 100)"
    )


def check_convex(model):
    pieces = (model.geom_group == COLLISION_GROUP) & (model.geom_type == mujoco.mjtGeom.mjGEOM_MESH)
    for geom in np.flatnonzero(pieces):
        mesh = model.mesh(model.geom_dataid[geom])
        vertices = model.mesh_vert[mesh.vertadr[0] :][: mesh.vertnum[0]].astype(float)
        first, second, third = vertices[model.mesh_face[mesh.faceadr[0] :][: mesh.facenum[0]]].transpose(1, 0, 2)
        normals = np.cross(second - first, third - first)
        doubled_m2 = np.linalg.norm(normals, axis=1)
        longest_m = np.linalg.norm([second - first, third - second, first - third], axis=2).max(axis=0)
        fat = doubled_m2 > SLIVER_M * longest_m
        normals = normals[fat] / doubled_m2[fat, None]
        out_m = (vertices @ normals.T - (first[fat] * normals).sum(axis=1)).max(initial=0)
        require(
            out_m < SLACK_M, f"mesh {mesh.name} collides but is not convex: a vertex is {out_m:.3f} m before a face"
        )


def shoot(model, points, directions):
    """How far the rays go to the collision geometry; -1 where there is none."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    groups = np.zeros(mujoco.mjNGROUP, dtype=np.uint8)
    groups[COLLISION_GROUP] = 1
    along_m, hit = np.empty(directions.shape[:2]), np.empty(directions.shape[1], dtype=np.int32)
    for point, fan, lengths_m in zip(points, directions, along_m, strict=True):
        mujoco.mj_multiRay(
            model, data, point, fan.ravel(), groups, True, -1, hit, lengths_m, None, len(fan), mujoco.mjMAXVAL
        )
    return along_m


if __name__ == "__main__":
    run(verify)
