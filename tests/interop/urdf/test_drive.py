"""Injected faults must stop the Husky: `cargo xtask interop` runs this."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

CHECK = Path(__file__).with_name("drive.py")


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    """The default cave: `cave`, and `package` made of it."""
    folder = tmp_path_factory.mktemp("urdf")
    output = ["--output", str(folder / "package"), "--keep", str(folder / "cave")]
    export = ["export", "--target", "urdf", *output, "--set", "texture.size_px=256", "--quiet"]
    subprocess.run([sys.executable, "-m", "plume", *export], check=True)
    return folder


def verify(package, cave, picture):
    command = [sys.executable, CHECK, package, cave / "graph.json", picture]
    result = subprocess.run(command, capture_output=True, text=True)
    return result.returncode, result.stdout + result.stderr


def in_urdf(old, new, count=0):
    def change(package):
        urdf = package / "cave/urdf/cave.urdf"
        text, found = re.subn(old, new, urdf.read_text(), count=count)
        assert found
        urdf.write_text(text)

    return change


def dig(package):
    """Takes every hundredth triangle out."""
    for mesh in (package / "cave/meshes").glob("*_collision.obj"):
        lines = enumerate(mesh.read_text().splitlines())
        mesh.write_text("\n".join(line for number, line in lines if not line.startswith("f ") or number % 100))


def lose_mesh(package):
    min((package / "cave/meshes").glob("*_collision.obj")).unlink()


def rename(package):
    (package / "cave").rename(package / "grotto")


FAULTS = {
    "convex hulls": (in_urdf(' concave="yes"', ""), "no floor under start frame"),
    "no friction": (in_urdf('(lateral_friction value)="[^"]*"', r'\1="0"'), "the Husky"),
    "a world that weighs": (in_urdf('mass value="0"', 'mass value="1"'), "the world has moved"),
    "a missing mesh": (lose_mesh, "Bullet cannot load"),
    "a path into another package": (in_urdf("package://cave/", "package://grotto/", 1), "Bullet cannot load"),
    "a package in a folder of another name": (rename, "Bullet cannot load"),
    "nothing to touch": (in_urdf(r"<collision[\s\S]*?</collision>", ""), "no floor under"),
    "holes": (dig, "no floor under"),
    "a start frame in the air": (in_urdf(r'(<origin xyz="\S+ \S+) \S+"', r'\1 0.9"', 1), "above the floor"),
    "no start frames": (in_urdf("_spawn_", "_start_"), "no frame for a start pose"),
}


def test_a_good_package_passes(folder):
    code, said = verify(folder / "package", folder / "cave", folder / "drive.png")
    assert code == 0 and "drove 2" in said, said


@pytest.mark.parametrize("fault", FAULTS)
def test_a_faulty_package_fails(fault, folder, tmp_path):
    change, message = FAULTS[fault]
    shutil.copytree(folder / "package", tmp_path / "package")
    change(tmp_path / "package")
    code, said = verify(tmp_path / "package", folder / "cave", tmp_path / "drive.png")
    assert code == 1 and message in said, said
