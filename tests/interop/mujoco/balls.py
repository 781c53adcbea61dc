"""Drops a thousand balls at random free points of a cave in MuJoCo.

    balls.py PACKAGE_DIR [CAVE_DIR]

Every ball starts in the open, none touches another, and each must come to rest inside, on the wall:

- its centre is in the open by the visual mesh;
- it was slower than 5 cm/s for half a second, 16 s after the drop at the latest, or as much later as all falls more slowly where
  gravity is weak;
- the nearest point of the visual mesh is one radius from its centre, give or take the tolerance of the pieces it touches (floor
  2 cm, others 5 cm) and 2 mm for the soft contacts of MuJoCo.

The balls do not turn, so they slide to a stop where the friction of the rock holds them, instead of rolling for minutes; on
steeper rock they go on until something stops them, and the air drags on them, so that they do not get faster and faster. Neither
moves the places where a ball can rest. The last line of a success tells how high they lie over the visual mesh and, with
CAVE_DIR, over the floor of the field that the cave was made from.
"""

import mujoco
import numpy as np
from floor import heights_m
from package import Wall, cave_spec, require, run, tolerances_m

COUNT = 1000
SEED = 1
RADIUS_M = 0.1
MARGIN_M = 0.06  # beyond any tolerance: no ball starts in a piece
DRAG_N_S_M = 1.0  # a ball of 1 kg falls at 10 m/s at most
DURATION_S = 16.0  # at the gravity of the Earth
EARTH_M_S2 = 9.81
REST_S = 0.5
REST_SPEED_M_S = 0.05
SLACK_M = 0.002


def verify(package, cave=None):
    wall = Wall(package)
    starts = wall.free_points(COUNT, RADIUS_M + MARGIN_M, np.random.default_rng(SEED))
    spec = with_balls(package, starts)
    rests, restless, most_m = settle(spec)
    nearest, open_m = wall.nearest(rests)
    gaps_m = open_m - RADIUS_M
    outside, deep, aloft = open_m < 0, gaps_m < -most_m, gaps_m > most_m
    faults = [(outside, "outside"), (deep & ~outside, "too deep"), (aloft, "in the air"), (restless, "still moving")]
    said = [f"{told.sum()} {what} (the first at {rests[told][0].round(2)})" for told, what in faults if told.any()]
    require(not said, f"of {COUNT} balls are " + ", ".join(said))
    summary = f"MuJoCo: {COUNT} balls at rest, over the visual mesh {figures(gaps_m)}"
    if cave is None:
        return summary
    import plume  # only here, so that a package alone needs none

    touches = rests + (nearest - rests) * (RADIUS_M / open_m)[:, None]
    with plume.open(cave) as cave:
        return f"{summary}; where they touch, over the field's floor {figures(heights_m(cave, touches))}"


def with_balls(package, starts):
    """The cave with a ball at each of the points."""
    spec = cave_spec(package)
    for number, start in enumerate(starts):
        body = spec.worldbody.add_body(pos=start)
        for axis in np.eye(3):
            body.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis, damping=DRAG_N_S_M)
        # It collides with geoms that have the first bit in `contype`, like rock, but not with other balls.
        sphere = mujoco.mjtGeom.mjGEOM_SPHERE
        body.add_geom(name=f"ball_{number}", type=sphere, size=[RADIUS_M, 0, 0], mass=1, contype=0, conaffinity=1)
    return spec


def settle(spec):
    """Steps until every ball rests or the time is up; gives their centres, which do not rest, and how far from the wall of
    the visual mesh what they lie on may be."""
    model = spec.compile()
    # Most balls lie still after three seconds, and the last ones move for ten.
    sleep = int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    model.opt.enableflags |= sleep
    data = mujoco.MjData(model)
    calm_since_s = np.zeros(COUNT)
    duration_s = DURATION_S * np.sqrt(EARTH_M_S2 / np.linalg.norm(model.opt.gravity))
    while data.time < duration_s:
        mujoco.mj_step(model, data)
        moving = np.linalg.norm(data.qvel.reshape(COUNT, 3), axis=1) > REST_SPEED_M_S
        calm_since_s[moving] = data.time
        if (data.time - calm_since_s).min() > REST_S:
            break
    # Bodies that sleep have no contacts, by which the tolerance is known.
    model.opt.enableflags &= ~sleep
    mujoco.mj_forward(model, data)
    most_m = np.full(model.ngeom, SLACK_M)
    touching = data.contact.geom
    tolerances = tolerances_m(model, spec)[touching].max(axis=1)
    np.maximum.at(most_m, touching, tolerances[:, None] + SLACK_M)
    balls = [model.geom(f"ball_{number}").id for number in range(COUNT)]
    return data.geom_xpos[balls].copy(), data.time - calm_since_s < REST_S, most_m[balls]


def figures(lengths_m):
    found = lengths_m[np.isfinite(lengths_m)] * 1000
    return f"mean {found.mean():.1f} mm, from {found.min():.1f} to {found.max():.1f} mm"


if __name__ == "__main__":
    run(verify)
