"""Measures what two robots get over, on planes and boxes: the steps and slopes that `truth/robot.rs` grants them.

    limits.py [MUJOCO_PACKAGE_DIR]

The Husky of `pybullet_data` in Bullet, or the rover of a MuJoCo package. Prints

- the highest step across its whole way that it climbs,
- the highest box between its left wheels over which it turns on the spot,
- how far it turns on the spot in four seconds, and how far it slides meanwhile, by friction and by slope as a share of that at which
  wheels slip: the least turn and the longest way of three headings.
"""

import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import mujoco
import numpy as np
import pybullet as p
from scipy.spatial.transform import Rotation

sys.path += [str(Path(__file__).parents[1]), str(Path(__file__).parents[1] / "mujoco")]
from husky import Husky, only_own_words  # noqa: E402
from package import name_of  # noqa: E402
from rover import Rover  # noqa: E402

GRAVITY_M_S2 = 9.81
FRICTION = 0.8
HEIGHTS_M = np.arange(0.06, 0.2, 0.005)
STEP = ([2, 2], [3, 0])  # half sides and centre
BETWEEN = ([0.08, 0.1], [0, 0.28])
AHEAD_M_S = 0.5
TURN_RAD_S = 1.0
DURATION_S = 5.0
TURN_S = 4.0
CLIMBED_M = 1.8  # from the start
TURNED_DEG = 45
SHARES = (0.4, 0.5, 0.6, 0.65, 0.7, 0.75)
FRICTIONS = (0.3, 0.4, 0.6, 0.8, 1.0)
HEADINGS_DEG = (0, 45, 90)


def main(package):
    def make(**world):
        return rover(package, **world) if package else husky(**world)

    with only_own_words() as say:
        climbed = [height_m for height_m in HEIGHTS_M if climbs(make(box=STEP, height_m=height_m))]
        turned = [height_m for height_m in HEIGHTS_M if turns(make(box=BETWEEN, height_m=height_m))]
        say(f"climbs steps of {span(climbed)}, turns over boxes of {span(turned)}")
        say("friction " + " ".join(f"{share:12.0%}" for share in SHARES))
        for friction in FRICTIONS:
            turned = [turn_on_slope(make, friction, share) for share in SHARES]
            say(f"{friction:8.1f} " + " ".join(f"{deg:5.0f}° {slid_m:.2f} m" for deg, slid_m in turned))


def husky(friction=FRICTION, slope_rad=0.0, box=None, height_m=0.0):
    """On a plane in Bullet, where wheels have a friction of 1 and that of both bodies is multiplied."""
    p.connect(p.DIRECT) if not p.isConnected() else p.resetSimulation()
    p.setGravity(*downhill(slope_rad))
    bodies = [p.createMultiBody(0, p.createCollisionShape(p.GEOM_PLANE))]
    if box:
        half, centre = box
        shape = p.createCollisionShape(p.GEOM_BOX, halfExtents=[*half, height_m / 2])
        bodies.append(p.createMultiBody(0, shape, basePosition=[*centre, height_m / 2]))
    for body in bodies:
        p.changeDynamics(body, -1, lateralFriction=friction)
    return Husky([0, 0, 0])


def rover(package, friction=FRICTION, slope_rad=0.0, box=None, height_m=0.0):
    """On a plane in MuJoCo, with the options of the package. The larger friction of two bodies counts."""
    cave = ElementTree.parse(package / f"{name_of(package)}.xml").getroot()
    world = ElementTree.Element("mujoco")
    ElementTree.SubElement(world, "include", file=str((package / "rover.xml").resolve()))
    world.append(cave.find("option"))
    bodies = ElementTree.SubElement(world, "worldbody")
    ElementTree.SubElement(bodies, "geom", type="plane", size="50 50 1")
    if box:
        half, centre = box
        size, pos = [" ".join(map(str, [*xy, height_m / 2])) for xy in (half, centre)]
        ElementTree.SubElement(bodies, "geom", type="box", size=size, pos=pos)
    ElementTree.SubElement(ElementTree.SubElement(world, "keyframe"), "key", name="plane_start")
    model = mujoco.MjModel.from_xml_string(ElementTree.tostring(world, encoding="unicode"))
    model.geom_friction[:, 0] = friction
    model.opt.gravity[:] = downhill(slope_rad)
    return Rover(model, "plane")


def downhill(slope_rad):
    return [-GRAVITY_M_S2 * np.sin(slope_rad), 0, -GRAVITY_M_S2 * np.cos(slope_rad)]


def climbs(robot):
    start(robot, 0)
    robot.steer(AHEAD_M_S, 0)
    robot.run(DURATION_S)
    return robot.position[0] > CLIMBED_M


def turns(robot):
    start(robot, 0)
    return turned_deg(robot, -TURN_RAD_S) > TURNED_DEG


def turn_on_slope(make, friction, share):
    robot = make(friction=friction, slope_rad=share * np.arctan(friction))

    def turned(heading_deg):
        start(robot, heading_deg)
        before = robot.position
        return turned_deg(robot, TURN_RAD_S), np.linalg.norm(robot.position - before)

    turns_deg, slides_m = zip(*map(turned, HEADINGS_DEG), strict=True)
    return min(turns_deg), max(slides_m)


def start(robot, heading_deg):
    robot.put_down([0, 0, 0.02], Rotation.from_euler("z", heading_deg, degrees=True).as_quat())
    robot.run(0.5)


def turned_deg(robot, turn_rad_s):
    """How far a robot turns in the direction that it is told to."""
    before = robot.axes[:, 0]
    robot.steer(0, turn_rad_s)
    robot.run(TURN_S)
    after = robot.axes[:, 0]
    turned = np.arctan2(before[0] * after[1] - before[1] * after[0], before @ after)
    return np.degrees(turned) * np.sign(turn_rad_s)


def span(heights_m):
    """The highest of those below the first that is missing."""
    gaps = np.flatnonzero(~np.isin(HEIGHTS_M, heights_m))
    count = gaps[0] if len(gaps) else len(HEIGHTS_M)
    return f"{HEIGHTS_M[count - 1]:.3f} m" if count else "none"


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else None)
