"""Drops a ball at each start pose of a USD package in Newton, which shares no code with PhysX and is free software.

    newton_drop.py PACKAGE_DIR

The balls must come to rest on the triangles of the package. They are added by a separate layer above the stage, in which what
moves by itself is switched off. In the stage alone Newton must see every thing of `instances.json` and no other, the movable ones
as bodies of the listed mass at their places. Whether they stay there is not asked: XPBD turns the millimetres by which triangles
that collide are above those that are seen into speed.
The first run compiles for a minute, later ones take seconds. It does not look at rays, friction or the height of start poses.
"""

import tempfile
from pathlib import Path

import newton
import numpy as np
import package as packages
from package import require, run
from physx import check_balls, dropped, match
from pxr import Usd

STEP_S = 1 / 240
DURATION_S = 3.0
MASS_SHARE = 1e-4
PLACE_M = 1e-4


def verify(package):
    root = packages.root_layer(package)
    stage = packages.open_stage(root)
    rock = packages.rock(stage, with_bodies=False)
    poses = packages.spawns(stage)
    listed = packages.listed_things(package)
    check_things(root, listed)
    with tempfile.TemporaryDirectory() as folder:
        layer = Path(folder) / "dropped.usda"
        deepest = check_balls(rock, poses, simulate(layer, with_balls(layer, root, poses)))
    movable = sum(thing["movable"] for thing in listed)
    resting = f"{len(poses)} balls at rest on {len(rock)} triangles within {deepest * 1000:.1f} mm"
    return f"Newton: {resting}; {len(listed)} things, {movable} of them movable"


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


def with_balls(layer, root, poses):
    """Writes the stage with the balls; gives where they start."""
    stage = Usd.Stage.CreateNew(str(layer))
    stage.GetRootLayer().subLayerPaths.append(str(root.resolve()))
    stage.SetMetadata("upAxis", "Z")
    stage.SetMetadata("metersPerUnit", 1.0)
    starts = dropped(stage, poses)
    stage.GetRootLayer().Save()
    return starts


def simulate(layer, starts):
    builder = newton.ModelBuilder()
    builder.add_usd(str(layer))
    model = builder.finalize(device="cpu")
    solver = newton.solvers.SolverXPBD(model)
    now, then, contacts = model.state(), model.state(), model.contacts()
    order = match(starts, positions(now))
    for _ in range(round(DURATION_S / STEP_S)):
        now.clear_forces()
        model.collide(now, contacts)
        solver.step(now, then, model.control(), contacts, STEP_S)
        now, then = then, now
    speeds_m_s = np.linalg.norm(positions(now) - positions(then), axis=1) / STEP_S
    return {"positions": positions(now)[order], "speeds_m_s": speeds_m_s[order]}


def positions(state):
    return state.body_q.numpy()[:, :3].copy()


if __name__ == "__main__":
    run(verify)
