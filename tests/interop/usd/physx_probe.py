"""Queries PhysX about a stage: `physx_probe.py STAGE QUESTION.npz ANSWER.npz`, for a Python with ovphysx and without USD.

The question holds rays and a duration; the answer how far each ray goes (infinite if it hits nothing), and of the rigid
bodies, in an order of PhysX's own, where they were at first, where they are when the time is over, and how fast they move.
"""

import sys
import warnings

import numpy as np
import ovphysx
import ovstage
from ovphysx import PhysX
from ovphysx.samples.python_samples.schema_support import physx_schema_paths
from ovphysx.types import ObjectScope, SceneQueryMode, SimObjectType

STEP_S = 1 / 240


def main(layer, question, answer):
    PhysX.set_cpu_mode(True)
    schemas = [*map(str, physx_schema_paths()), str(ovphysx.newton_schema_root())]
    ovstage.population.register_usd_schemas(schemas)
    stage = ovstage.Stage("cave")
    ovstage.population.open_usd(stage, layer, ordinal=1, domains=ovstage.PopulationDomain.ALL)
    stage.advance_write_floor(ordinal=1).wait()
    physx = PhysX()
    physx.wait_task(physx.attach_ovstage(stage, read_ordinal=1))
    physx.step_sync(STEP_S)
    with np.load(question) as asked:
        rays = zip(asked["origins"], asked["directions"], strict=True)
        distances = [cast(physx, *ray, asked["length_m"]) for ray in rays]
        starts = positions(physx)
        for _ in range(int(asked["duration_s"] / STEP_S)):
            physx.step_sync(STEP_S)
    before = positions(physx)
    physx.step_sync(STEP_S)
    after = positions(physx)
    speeds_m_s = np.linalg.norm(after - before, axis=1) / STEP_S
    np.savez(answer, distances=distances, starts=starts, positions=after, speeds_m_s=speeds_m_s)
    physx.wait_all()
    physx.wait_task(physx.detach_ovstage())
    physx.destroy()
    stage.destroy()


def cast(physx, origin, direction, length_m):
    hits = physx.raycast(tuple(origin), tuple(direction), float(length_m), SceneQueryMode.CLOSEST)
    return hits[0]["distance"] if hits else np.inf


def positions(physx):
    """Of every rigid body."""
    with physx.read_sync(SimObjectType.RIGID_BODY, ["position"], scope=ObjectScope.ALL) as read:
        found = [np.array(tensor.numpy()).reshape(-1, 3) for group in read.groups for tensor in group.tensors]
    return np.concatenate(found) if found else np.zeros((0, 3))


if __name__ == "__main__":
    # The library announces that rays will be cast by other functions some day; its version is pinned.
    warnings.simplefilter("ignore", DeprecationWarning)
    main(*sys.argv[1:])
