"""Drops a thousand balls at random free points of a cave in MuJoCo.

    balls.py PACKAGE_DIR [CAVE_DIR]

Every ball starts in the open, none touches another, and each must come to rest inside, on the wall:

- its centre is in the open by the visual mesh;
- it was slower than 5 cm/s for half a second, 12 s after the drop at the latest;
- the nearest point of the visual mesh is one radius from its centre, give or take the tolerance of the pieces there (floor
  2 cm, elsewhere 5 cm) and 2 mm for the soft contacts of MuJoCo.

Balls on a slope would roll for minutes. These have a rolling friction that holds on any floor, and the air drags on them (neither
moves the place where a ball can rest); on rock steeper than its own friction they slide until something stops them. The
last line of a success tells how high they lie over the visual mesh and, with CAVE_DIR, over the floor of the field that
the cave was made from.
"""

import mujoco
import numpy as np
from package import Wall, cave_spec, require, run

COUNT = 1000
SEED = 1
RADIUS_M = 0.1
MARGIN_M = 0.06  # beyond any tolerance: no ball starts in a piece
FRICTION = [0, 0.1, 0.1]  # sliding: as the rock says; twisting and rolling, in metres
DRAG_N_S_M = 1.0  # a ball of 1 kg falls at 10 m/s at most
DURATION_S = 12.0
REST_S = 0.5
REST_SPEED_M_S = 0.05
SLACK_M = 0.002
STEP_M = 0.005  # between probes of the field
PROBED_M = 0.5


def judge(package, cave=None):
    wall = Wall(package)
    starts = wall.free_points(COUNT, RADIUS_M + MARGIN_M, np.random.default_rng(SEED))
    rests, restless = settle(with_balls(package, starts))
    nearest, open_m, tolerances_m = wall.nearest(rests)
    gaps_m = open_m - RADIUS_M
    outside, deep = open_m < 0, gaps_m < -tolerances_m - SLACK_M
    aloft = gaps_m > tolerances_m + SLACK_M
    faults = [(outside, "outside"), (deep & ~outside, "too deep"), (aloft, "in the air"), (restless, "still moving")]
    said = [f"{told.sum()} {what} (the first at {rests[told][0].round(2)})" for told, what in faults if told.any()]
    require(not said, f"of {COUNT} balls are " + ", ".join(said))
    praise = f"MuJoCo: {COUNT} balls at rest, over the visual mesh {figures(gaps_m)}"
    if cave is None:
        return praise
    return f"{praise}, over the field's floor {figures(over_field(cave, rests + (nearest - rests) * (RADIUS_M / open_m)[:, None]))}"


def with_balls(package, starts):
    """The cave with a ball at each of the points."""
    spec = cave_spec(package)
    for start in starts:
        body = spec.worldbody.add_body(pos=start)
        body.add_joint(type=mujoco.mjtJoint.mjJNT_FREE, damping=DRAG_N_S_M)
        # It touches what has the first bit in `contype`, as rock has, and no other ball.
        sphere = mujoco.mjtGeom.mjGEOM_SPHERE
        body.add_geom(type=sphere, size=[RADIUS_M, 0, 0], mass=1, condim=6, friction=FRICTION, contype=0, conaffinity=1)
    return spec.compile()


def settle(model):
    """Steps until every ball rests or the time is up; gives their centres, and which do not rest."""
    data = mujoco.MjData(model)
    calm_since_s = np.zeros(COUNT)
    while data.time < DURATION_S:
        mujoco.mj_step(model, data)
        moving = np.linalg.norm(data.qvel.reshape(COUNT, 6)[:, :3], axis=1) > REST_SPEED_M_S
        calm_since_s[moving] = data.time
        if (data.time - calm_since_s).min() > REST_S:
            break
    return data.qpos.reshape(COUNT, 7)[:, :3].copy(), data.time - calm_since_s < REST_S


def over_field(cave, touches):
    """Heights of points over the floor of the field, straight below or above them."""
    import plume

    steps_m = np.arange(PROBED_M, -PROBED_M, -STEP_M)
    columns = touches[:, None] + np.stack([0 * steps_m, 0 * steps_m, steps_m], axis=1)
    with plume.open(cave) as cave:
        field_m = cave.distance(columns.reshape(-1, 3)).reshape(columns.shape[:2])
    # From the open above into the rock below; of several floors the one that is next to the point.
    enters = (field_m[:, :-1] < 0) & (field_m[:, 1:] >= 0)
    share = field_m[:, :-1] / (field_m[:, :-1] - field_m[:, 1:] + ~enters)
    heights_m = np.where(enters, share * STEP_M - steps_m[:-1], np.inf)
    best = np.abs(heights_m).argmin(axis=1)
    return heights_m[np.arange(len(touches)), best]


def figures(lengths_m):
    found = lengths_m[np.isfinite(lengths_m)] * 1000
    return f"mean {found.mean():.1f} mm, from {found.min():.1f} to {found.max():.1f} mm"


if __name__ == "__main__":
    run(judge)
