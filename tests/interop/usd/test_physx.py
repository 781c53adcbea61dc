"""PhysX must notice what robots would: `cargo xtask interop` runs this with the variable PLUME_PHYSX_PYTHON."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from pxr import Gf, Usd, UsdPhysics

CHECK = Path(__file__).with_name("physx.py")


@pytest.fixture(scope="session")
def package(tmp_path_factory):
    folder = tmp_path_factory.mktemp("package") / "isaac"
    small = ["--set", "graph.nodes=12", "--set", "texture.size_px=256", "--quiet"]
    command = [sys.executable, "-m", "plume", "export", "--target", "isaac", "--output", str(folder), *small]
    subprocess.run(command, check=True)
    return folder


def verify(package):
    command = [sys.executable, CHECK, package, os.environ["PLUME_PHYSX_PYTHON"]]
    result = subprocess.run(command, capture_output=True, text=True)
    return result.returncode, result.stdout + result.stderr


def on_collisions(change):
    def edited(package):
        for layer in sorted((package / "chunks").glob("*.usdc")):
            stage = Usd.Stage.Open(str(layer))
            change(stage.GetPrimAtPath("/Chunk/Collision"))
            stage.GetRootLayer().Save()

    return edited


def on_root(change):
    def edited(package):
        stage = Usd.Stage.Open(str(package / "cave.usda"), Usd.Stage.LoadNone)
        change(stage)
        stage.GetRootLayer().Save()

    return edited


def make_hull(prim):
    UsdPhysics.MeshCollisionAPI(prim).GetApproximationAttr().Set("convexHull")


def stop_colliding(prim):
    prim.RemoveAPI(UsdPhysics.CollisionAPI)


def lift_spawn(stage):
    attribute = stage.GetPrimAtPath("/World/Spawns/spawn_0").GetAttribute("xformOp:translate")
    attribute.Set(attribute.Get() + Gf.Vec3d(0, 0, 0.5))


def float_away(stage):
    UsdPhysics.Scene.Get(stage, "/PhysicsScene").GetGravityMagnitudeAttr().Set(0.0)


def make_ice(stage):
    ground = UsdPhysics.MaterialAPI.Get(stage, "/World/Materials/Ground")
    ground.GetStaticFrictionAttr().Set(0.0)
    ground.GetDynamicFrictionAttr().Set(0.0)


FAULTS = {
    "convex hulls": (on_collisions(make_hull), "the triangles are"),
    "no collision": (on_collisions(stop_colliding), "leaves the cave"),
    "a start pose in the air": (on_root(lift_spawn), "spawn_0 is 0.5"),
    "no gravity": (on_root(float_away), "rests"),
    "no friction": (on_root(make_ice), "without friction"),
}


def test_a_good_package_passes(package):
    code, said = verify(package)
    assert code == 0, said


@pytest.mark.parametrize("fault", FAULTS)
def test_a_faulty_package_fails(fault, package, tmp_path):
    change, message = FAULTS[fault]
    shutil.copytree(package, tmp_path / "package")
    change(tmp_path / "package")
    code, said = verify(tmp_path / "package")
    assert code == 1 and message in said, said
