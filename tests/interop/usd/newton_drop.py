"""Drops a ball at each start pose of a USD package in Newton, which shares no code with PhysX and is free software, and on stones.

    newton_drop.py PACKAGE_DIR

The balls at start poses must come to rest on the triangles of the package. Those over the widest stones must be stopped by the top
of the stone, and may then roll off it, but not into rock; a merged collision mesh has no stones of their own. All are added by a
separate layer above the stage, in which what moves by itself is switched off. In the stage alone Newton must see every thing of
`instances.json` and no other (of a package with a merged collision mesh, every movable one), the movable ones as bodies of the
listed mass at their places. Whether they stay there is not asked: XPBD turns the millimetres by which triangles that collide are
above those that are seen into speed.
The first run compiles for a minute, later ones take seconds. It does not look at rays, friction or the height of start poses.
"""

import tempfile
from pathlib import Path

import newton
import numpy as np
import package as packages
from package import require, run
from physx import BALL_RADIUS_M, CONTACT_M, check_balls, define_ball, distance, dropped, match, nearest
from pxr import Usd, UsdGeom

STEP_S = 1 / 240
DURATION_S = 3.0
MASS_SHARE = 1e-4
PLACE_M = 1e-4
STONES = ("boulder", "slab", "lining_slab", "ropy_slab")
MOST_STONES = 8
OVER_STONE_M = 0.3  # height of a ball over the top of its stone
BESIDE_M = 1.0  # balls start at least this far from each other, so that they do not touch
LANDED_S = 0.28  # a ball has been on its stone for 33 ms; one in free fall would be 8 cm lower
SUNK_M = 0.01  # more than a ball rolls down from a stone in that time


def verify(package):
    root = packages.root_layer(package)
    stage = packages.open_stage(root)
    rock = packages.rock(stage, with_bodies=False)
    poses = packages.spawns(stage)
    listed = packages.listed_things(package)
    touched = [thing for thing in listed if thing["movable"] or not packages.merged(stage)]
    check_things(root, touched)
    tops = tops_of_stones(stage, touched, rock, poses)
    with tempfile.TemporaryDirectory() as folder:
        layer = Path(folder) / "dropped.usda"
        seen = simulate(layer, with_balls(layer, root, poses, tops))
    deepest = check_balls(rock, poses, {name: of_balls[: len(poses)] for name, of_balls in seen.items()})
    check_stones(rock, tops, {name: of_balls[len(poses) :] for name, of_balls in seen.items()})
    movable = sum(thing["movable"] for thing in listed)
    resting = f"{len(poses)} balls at rest on {len(rock)} triangles within {deepest * 1000:.1f} mm"
    return f"Newton: {resting}, {len(tops)} stopped by stones; {len(touched)} things, {movable} of them movable"


def check_things(root, listed):
    builder = newton.ModelBuilder()
    builder.add_usd(str(root))
    names = sorted(name_of(thing) for thing in listed)
    touched = touched_things(builder)
    require(touched == names, f"Newton touches {len(touched)} things, {len(names)} are listed")
    bodies = {path.split("/")[-1]: body for body, path in enumerate(builder.body_label)}
    movable = {name_of(thing): thing for thing in listed if thing["movable"]}
    require(bodies.keys() == movable.keys(), f"Newton moves {len(bodies)} things, {len(movable)} are movable")
    for name, thing in movable.items():
        body = bodies[name]
        kg, off_m = builder.body_mass[body], np.abs(np.array(builder.body_q[body])[:3] - thing["position"]).max()
        require(abs(kg - thing["mass_kg"]) < MASS_SHARE * thing["mass_kg"], f"{name} has {kg} kg")
        require(off_m < PLACE_M, f"{name} is {off_m:.4f} m from its place")


def name_of(thing):
    return f"{thing['class']}_{thing['id']}"


def touched_things(builder):
    """Names of the things that collide, each as often as it has a shape that does."""
    shapes = zip(builder.shape_label, builder.shape_flags, strict=True)
    paths = [path.split("/") for path, flags in shapes if flags & newton.ShapeFlags.COLLIDE_SHAPES]
    # /World/Chunks/<chunk>/<zone>/<thing>/Collision
    return sorted(path[5] for path in paths if len(path) == 7 and path[6] == "Collision")


def tops_of_stones(stage, listed, rock, poses):
    """The tops of the widest stones over which a ball has room, by the names of the stones."""
    stones = {name_of(thing): thing["class"] in STONES and not thing["movable"] for thing in listed}
    hulls = {thing.GetName(): hull_of(thing) for thing in packages.instances(stage) if stones.get(thing.GetName())}
    taken, tops = list(poses[:, :3, 3]), {}
    for name in sorted(hulls, key=lambda name: (-width_m(hulls[name]), name)):
        corners = hulls[name].reshape(-1, 3)
        top = corners[corners[:, 2].argmax()]
        is_apart = np.linalg.norm(np.array(taken) - top, axis=1).min() > BESIDE_M
        if len(tops) < MOST_STONES and is_apart and has_room(rock, hulls[name], top):
            tops[name] = top
            taken.append(top)
    return tops


def hull_of(thing):
    """Corners of what a thing is touched by, in metres in the frame of the stage, shape (triangle, corner, xyz)."""
    world_from_thing = np.asarray(UsdGeom.XformCache().GetLocalToWorldTransform(thing))
    hull = np.concatenate(
        [packages.triangles(UsdGeom.Mesh(prim)) for prim in packages.below(thing) if packages.is_collider(prim)]
    )
    return hull @ world_from_thing[:3, :3] + world_from_thing[3, :3]


def width_m(hull):
    return np.ptp(hull[:, :, :2], axis=(0, 1)).mean()


def has_room(rock, hull, top):
    """Whether a ball that falls on the top of a stone meets nothing else on its way, nor just below the top."""
    near = rock[((rock.min(axis=1) < top + BESIDE_M) & (rock.max(axis=1) > top - BESIDE_M)).all(axis=1)]
    of_hull = {triangle.tobytes() for triangle in hull}
    others = np.reshape([triangle for triangle in near if triangle.tobytes() not in of_hull], (-1, 3, 3))
    heights_m = BALL_RADIUS_M + np.linspace(-2 * SUNK_M, OVER_STONE_M, 8)
    return all(nearest(others, top + [0, 0, height_m]) > BALL_RADIUS_M for height_m in heights_m)


def with_balls(layer, root, poses, tops):
    """Writes the stage with the balls; gives where they start."""
    stage = Usd.Stage.CreateNew(str(layer))
    stage.GetRootLayer().subLayerPaths.append(str(root.resolve()))
    stage.SetMetadata("upAxis", "Z")
    stage.SetMetadata("metersPerUnit", 1.0)
    over_stones = [top + [0, 0, OVER_STONE_M + BALL_RADIUS_M] for top in tops.values()]
    for number, start in enumerate(over_stones, len(poses)):
        define_ball(stage, number, start)
    starts = np.concatenate([dropped(stage, poses), np.reshape(over_stones, (-1, 3))])
    stage.GetRootLayer().Save()
    return starts


def simulate(layer, starts):
    builder = newton.ModelBuilder()
    builder.add_usd(str(layer))
    model = builder.finalize(device="cpu")
    solver = newton.solvers.SolverXPBD(model)
    now, then, contacts = model.state(), model.state(), model.contacts()
    order = match(starts, positions(now))
    for step in range(round(DURATION_S / STEP_S)):
        now.clear_forces()
        model.collide(now, contacts)
        solver.step(now, then, model.control(), contacts, STEP_S)
        now, then = then, now
        if step + 1 == round(LANDED_S / STEP_S):
            landed = positions(now)
    speeds_m_s = np.linalg.norm(positions(now) - positions(then), axis=1) / STEP_S
    return {"positions": positions(now)[order], "speeds_m_s": speeds_m_s[order], "landed": landed[order]}


def check_stones(rock, tops, seen):
    sides = by_facing(rock)
    for (name, top), landed, end in zip(tops.items(), seen["landed"], seen["positions"], strict=True):
        sunk_m = top[2] - (landed[2] - BALL_RADIUS_M)
        require(sunk_m < SUNK_M, f"the ball on {name} is {sunk_m:.3f} m below its top")
        require(nearest(rock, end) > BALL_RADIUS_M - CONTACT_M, f"the ball on {name} ends in the rock")
        require(is_in_the_open(sides, end), f"the ball on {name} falls out of the cave")


def is_in_the_open(sides, point):
    """Whether the first triangle below is one that faces upwards, given those that do and the others."""
    upward_m, downward_m = (distance(side, point, np.array([0.0, 0.0, -1.0])) for side in sides)
    return upward_m < downward_m


def by_facing(rock):
    """Triangles that face upwards, and all others."""
    up = np.cross(rock[:, 1] - rock[:, 0], rock[:, 2] - rock[:, 0])[:, 2] > 0
    return rock[up], rock[~up]


def positions(state):
    return state.body_q.numpy()[:, :3].copy()


if __name__ == "__main__":
    run(verify)
