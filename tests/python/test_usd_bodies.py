"""The laws of movable things in USD packages: a good one passes, and each fault is noticed."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from pxr import Gf, Usd, UsdPhysics

sys.path.append(str(Path(__file__).parents[1] / "interop/usd"))

import body_laws  # noqa: E402 - next to the checks
import package as packages  # noqa: E402


@pytest.fixture(scope="module")
def movable(tmp_path_factory):
    """The package `usd` of a tiny cave with stones that move."""
    folder = tmp_path_factory.mktemp("movable") / "usd"
    tiny = ["--set", "graph.nodes=4", "--set", "texture.size_px=256", "--set", "things.movable_m=0.2"]
    arguments = ["export", "--target", "usd", "--output", str(folder), "--quiet", *tiny]
    subprocess.run([sys.executable, "-m", "plume", *arguments], check=True)
    return folder


def broken(package):
    root = packages.root_layer(package)
    stage = packages.open_stage(root)
    of_stage = [line for law in body_laws.LAWS for line in law(stage)]
    return [*of_stage, *(line for law in body_laws.FILE_LAWS for line in law(package, root))]


def test_a_good_package_passes(movable):
    assert broken(movable) == []
    stage = packages.open_stage(packages.root_layer(movable))
    assert 0 < len(packages.bodies(stage)) < len(packages.instances(stage))


def on(pattern, change):
    """Changes the first thing of the first layer that the pattern finds."""

    def edit(package):
        stage = Usd.Stage.Open(str(sorted((package / "chunks").glob(pattern))[0]))
        change(packages.instances(stage)[0])
        stage.GetRootLayer().Save()

    return edit


def on_body(change):
    return on("movable_*.usdc", lambda thing: change(UsdPhysics.MassAPI(thing)))


def forget(package):
    file = package / "instances.json"
    listed = json.loads(file.read_text())
    listed["things"].pop()
    file.write_text(json.dumps(listed))


def make_rigid(thing):
    UsdPhysics.RigidBodyAPI.Apply(thing.GetParent())


FAULTS = {
    "a stone that is not rigid": (
        on("movable_*.usdc", lambda thing: thing.RemoveAPI(UsdPhysics.RigidBodyAPI)),
        "is not movable",
    ),
    "dripstone that moves": (on("things_*.usdc", UsdPhysics.RigidBodyAPI.Apply), "has no mass"),
    "a rigid floor": (on("movable_*.usdc", make_rigid), "is a rigid body"),
    "no mass": (on("movable_*.usdc", lambda thing: thing.RemoveAPI(UsdPhysics.MassAPI)), "has no mass"),
    "another mass": (on_body(lambda mass: mass.GetMassAttr().Set(1.001 * mass.GetMassAttr().Get())), "are listed"),
    "a lopsided stone": (on_body(lambda mass: mass.GetCenterOfMassAttr().Set(Gf.Vec3f(0.01, 0, 0))), "centre of mass"),
    "a heavy axis": (
        on_body(lambda mass: mass.GetDiagonalInertiaAttr().Set(2 * mass.GetDiagonalInertiaAttr().Get())),
        "another inertia",
    ),
    "other axes": (on_body(lambda mass: mass.GetPrincipalAxesAttr().Set(Gf.Quatf(0.5, 0.5, 0.5, 0.5))), "inertia"),
    "another size": (on("movable_*.usdc", lambda thing: thing.GetAttribute("xformOp:scale").Set((2, 2, 2))), "inertia"),
    "another place": (
        on("movable_*.usdc", lambda thing: thing.GetAttribute("xformOp:translate").Set((0, 0, 0))),
        "is at [0",
    ),
    "a thing that is not there": (on("movable_*.usdc", lambda thing: thing.SetActive(False)), "are listed; not both"),
    "a thing that is not listed": (forget, "are listed; not both"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_noticed(fault, movable, tmp_path):
    inject, message = FAULTS[fault]
    package = tmp_path / "usd"
    shutil.copytree(movable, package)
    inject(package)
    lines = broken(package)
    assert any(message in line for line in lines), lines
