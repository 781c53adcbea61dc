"""Puts a USD package into PhysX, the engine of Isaac Sim, on the CPU.

    physx.py PACKAGE_DIR PYTHON_WITH_OVPHYSX

PhysX knows nothing of our exporter. From each start pose the ray straight down must hit the floor, and a hundred rays in
all directions must hit rock, within a millimetre of where they meet the triangles of the package; balls dropped at the start poses
must come to rest on the triangles; and pucks pushed along the floor must stop sooner than on a floor without friction.
The bodies are added by a separate layer above the stage; the package is not touched. Where nothing is added, PhysX must see the
movable things of the package as bodies; elsewhere they are switched off.
"""

import subprocess
import tempfile
from pathlib import Path

import numpy as np
import package as packages
from package import require, run
from pxr import Gf, Usd, UsdGeom, UsdPhysics, UsdShade

PROBE = Path(__file__).with_name("physx_probe.py")
RAYS = 100
RAY_LENGTH_M = 1000.0
EYE_M = 0.5  # rays start this far above a start pose, well inside the passage
TOLERANCE_M = 1e-3
BALL_RADIUS_M = 0.2
DROP_M = 0.6  # height of a ball's centre over its start pose
INERTIA_KG_M2 = 10.0  # 600 times that of a ball: it slides to a stop instead of rolling down every slope
CONTACT_M = 0.03
REST_SPEED_M_S = 0.05
PUSH_M_S = 3.0
DURATION_S = 3.0


def verify(package, python):
    root = packages.root_layer(package)
    stage = packages.open_stage(root)
    rock = packages.rock(stage, with_bodies=False)
    poses = packages.spawns(stage)
    origins, directions = rays(poses)
    with tempfile.TemporaryDirectory() as folder:
        ask = Probe(root, poses, Path(folder), python)
        cast = ask("alone", nothing, origins, directions)["distances"]
        check_rays(packages.rock(stage, with_bodies=True), origins, directions, cast, len(poses))
        deepest = check_balls(rock, poses, ask("dropped", dropped))
        check_friction(poses, ask("pushed", pushed)["positions"], ask("smooth", smooth)["positions"])
    return f"PhysX: {len(origins)} rays end on {len(rock)} triangles within 1 mm, {len(poses)} balls at rest within {deepest * 1000:.1f} mm"


def rays(poses):
    """Down from every start pose, then in all directions from one after the other."""
    random = np.random.default_rng(7)
    anywhere = random.standard_normal((RAYS, 3))
    anywhere /= np.linalg.norm(anywhere, axis=1, keepdims=True)
    eyes = poses[:, :3, 3] + [0, 0, EYE_M]
    down = np.tile([0.0, 0.0, -1.0], (len(poses), 1))
    return np.concatenate([eyes, eyes[np.arange(RAYS) % len(poses)]]), np.concatenate([down, anywhere])


class Probe:
    """Asks PhysX about the package with other bodies in it each time: where rays end, or how the bodies fare."""

    def __init__(self, root, poses, folder, python):
        self.root, self.poses, self.folder, self.python = root, poses, folder, python

    def __call__(self, name, bodies, origins=(), directions=()):
        layer = self.folder / f"{name}.usda"
        stage = Usd.Stage.CreateNew(str(layer))
        stage.GetRootLayer().subLayerPaths.append(str(self.root.resolve()))
        UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
        UsdGeom.SetStageMetersPerUnit(stage, 1.0)
        UsdPhysics.SetStageKilogramsPerUnit(stage, 1.0)
        starts = bodies(stage, self.poses)
        stage.GetRootLayer().Save()
        question, answer = self.folder / "question.npz", self.folder / "answer.npz"
        duration_s = 0.0 if len(origins) else DURATION_S
        np.savez(question, origins=origins, directions=directions, length_m=RAY_LENGTH_M, duration_s=duration_s)
        result = subprocess.run([self.python, PROBE, layer, question, answer], capture_output=True, text=True)
        require(result.returncode == 0, f"PhysX fails: {result.stdout[-2000:]}{result.stderr[-2000:]}")
        with np.load(answer) as said:
            order = match(starts, said["starts"])
            return {"distances": said["distances"]} | {key: said[key][order] for key in ["positions", "speeds_m_s"]}


def match(expected, found):
    """Matches bodies of PhysX with ours by their start positions."""
    require(len(found) == len(expected), f"PhysX moves {len(found)} bodies, not {len(expected)}")
    if not len(found):
        return []
    away = np.linalg.norm(found[None] - expected[:, None], axis=2)
    require((away.min(axis=1) < 0.1).all(), "PhysX starts bodies elsewhere")
    return away.argmin(axis=1)


def nothing(stage, poses):
    return packages.places(packages.bodies(stage))


def dropped(stage, poses):
    packages.hide_bodies(stage)
    starts = poses[:, :3, 3] + [0, 0, DROP_M]
    for number, start in enumerate(starts):
        define_ball(stage, number, start)
    return starts


def pushed(stage, poses):
    packages.hide_bodies(stage)
    starts = poses[:, :3, 3] + [0, 0, BALL_RADIUS_M]
    for number, start in enumerate(starts):
        ball = define_ball(stage, number, start)
        UsdPhysics.RigidBodyAPI(ball).CreateVelocityAttr(Gf.Vec3f(*(PUSH_M_S * poses[number, :3, 0])))
    return starts


def smooth(stage, poses):
    starts = pushed(stage, poses)
    # Whatever material the package binds to its rock; what the balls bring is still there.
    for mesh in packages.colliders(stage):
        material, _ = UsdShade.MaterialBindingAPI(mesh).ComputeBoundMaterial("physics")
        ground = UsdPhysics.MaterialAPI(material)
        ground.CreateStaticFrictionAttr(0.0)
        ground.CreateDynamicFrictionAttr(0.0)
    return starts


def define_ball(stage, number, position):
    ball = UsdGeom.Sphere.Define(stage, f"/Balls/ball_{number:02}")
    ball.CreateRadiusAttr(BALL_RADIUS_M)
    UsdGeom.XformCommonAPI(ball).SetTranslate(Gf.Vec3d(*position))
    prim = ball.GetPrim()
    UsdPhysics.CollisionAPI.Apply(prim)
    UsdPhysics.RigidBodyAPI.Apply(prim)
    mass = UsdPhysics.MassAPI.Apply(prim)
    mass.CreateMassAttr(1.0)
    mass.CreateDiagonalInertiaAttr(Gf.Vec3f(INERTIA_KG_M2))
    return prim


def check_rays(rock, origins, directions, distances, downward):
    for number, (origin, direction, seen) in enumerate(zip(origins, directions, distances, strict=True)):
        expected = distance(rock, origin, direction)
        kind = f"the ray down from spawn_{number}" if number < downward else f"ray {number - downward}"
        require(np.isfinite(seen), f"{kind} leaves the cave")
        require(
            abs(seen - expected) < TOLERANCE_M,
            f"{kind} hits after {seen:.4f} m, the triangles are {expected:.4f} m away",
        )
        if number < downward:
            require(abs(seen - EYE_M) < 0.15, f"spawn_{number} is {seen - EYE_M:.2f} m above the floor")


def distance(rock, origin, direction):
    """To the first triangle along a ray (Möller and Trumbore 1997); infinite if there is none."""
    a, ab, ac = rock[:, 0], rock[:, 1] - rock[:, 0], rock[:, 2] - rock[:, 0]
    across = np.cross(direction, ac)
    det = np.einsum("ij,ij->i", ab, across)
    with np.errstate(divide="ignore", invalid="ignore"):
        from_a = origin - a
        u = np.einsum("ij,ij->i", from_a, across) / det
        turned = np.cross(from_a, ab)
        v = turned @ direction / det
        along = np.einsum("ij,ij->i", ac, turned) / det
        hit = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1 + 1e-9) & (along > 0)
    return along[hit].min(initial=np.inf)


def check_balls(rock, poses, seen):
    gaps = []
    for number, (position, speed) in enumerate(zip(seen["positions"], seen["speeds_m_s"], strict=True)):
        require(speed < REST_SPEED_M_S, f"ball {number} still moves at {speed:.2f} m/s")
        away = np.linalg.norm(position - poses[number, :3, 3])
        require(away < 3.0, f"ball {number} rests {away:.1f} m from where it was dropped")
        gaps.append(abs(nearest(rock, position) - BALL_RADIUS_M))
        require(gaps[-1] < CONTACT_M, f"ball {number} rests {gaps[-1]:.3f} m off the triangles")
    return max(gaps)


def nearest(rock, point):
    """Distance from a point to the nearest triangle (Ericson, Real-Time Collision Detection 2004, 5.1.5, by regions)."""
    best = np.inf
    a, b, c = rock[:, 0], rock[:, 1], rock[:, 2]
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    height = np.einsum("ij,ij->i", point - a, normal)
    foot = point - height[:, None] * normal
    sides = [np.einsum("ij,ij->i", np.cross(q - p, foot - p), normal) for p, q in [(a, b), (b, c), (c, a)]]
    over = np.min(sides, axis=0) >= 0
    best = np.abs(height[over]).min(initial=best)
    for p, q in [(a, b), (b, c), (c, a)]:
        along = np.einsum("ij,ij->i", point - p, q - p) / np.einsum("ij,ij->i", q - p, q - p)
        closest = p + np.clip(along, 0, 1)[:, None] * (q - p)
        best = np.linalg.norm(closest - point, axis=1).min(initial=best)
    return best


def check_friction(poses, rough, smooth_):
    reach = [np.linalg.norm(positions - poses[:, :3, 3], axis=1) for positions in (rough, smooth_)]
    sooner = np.median(reach[0]) < np.median(reach[1])
    require(sooner, f"pushed balls go {np.median(reach[0]):.2f} m, without friction {np.median(reach[1]):.2f} m")


if __name__ == "__main__":
    run(verify)
