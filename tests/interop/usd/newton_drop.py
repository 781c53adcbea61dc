"""Drops a ball at each start pose of a USD package in Newton, which shares no code with PhysX and is free software.

    newton_drop.py PACKAGE_DIR

The balls must come to rest on the triangles of the package. They are added by a separate layer above the stage.
The first run compiles for a minute, later ones take seconds. It does not look at rays, friction or the height of start poses.
"""

import tempfile
from pathlib import Path

import newton
import numpy as np
import package as packages
from package import run
from physx import check_balls, dropped, match
from pxr import Usd

STEP_S = 1 / 240
DURATION_S = 3.0


def verify(package):
    root = packages.root_layer(package)
    stage = packages.open_stage(root)
    rock = packages.rock(stage)
    poses = packages.spawns(stage)
    with tempfile.TemporaryDirectory() as folder:
        layer = Path(folder) / "dropped.usda"
        deepest = check_balls(rock, poses, simulate(layer, with_balls(layer, root, poses)))
    return f"Newton: {len(poses)} balls at rest on {len(rock)} triangles within {deepest * 1000:.1f} mm"


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
