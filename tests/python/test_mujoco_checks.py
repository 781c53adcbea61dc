"""The checks of MuJoCo packages: a good one passes, and each fault is noticed."""

import json
import shutil
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest

CHECKS = Path(__file__).parents[1] / "interop/mujoco"
SMALL = ["--set", "graph.nodes=12", "--set", "texture.size_px=256", "--set", "things.cover=0.01"]
ZONES = ["cave_floor", "cave_wall", "cave_ceiling"]


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    """A package, with the cave that it was made from next to it."""
    folder = tmp_path_factory.mktemp("mujoco")
    places = ["--output", str(folder / "package"), "--keep", str(folder / "cave")]
    export = [sys.executable, "-m", "plume", "export", "--target", "mujoco", "--quiet", *places, *SMALL]
    subprocess.run(export, check=True)
    return folder / "package"


def verify(name, package, cave):
    """Exit code and output."""
    arguments = [package, cave] if name == "drive" else [package]
    result = subprocess.run([sys.executable, CHECKS / f"{name}.py", *arguments], capture_output=True, text=True)
    return result.returncode, result.stdout + result.stderr


@pytest.mark.parametrize("name", ["balls", "rays", "drive"])
def test_a_good_package_passes(name, package):
    code, said = verify(name, package, package.with_name("cave"))
    assert code == 0, said


def in_world(change):
    """A change of the cave's own elements."""

    def edited(package):
        root = whole(package / "cave_world.xml")
        change(root)
        ElementTree.ElementTree(root).write(package / "cave_world.xml")

    return edited


def whole(file):
    """A model with what it includes in its place."""
    root = ElementTree.parse(file).getroot()
    for include in root.findall("include"):
        place = list(root).index(include)
        root[place : place + 1] = list(ElementTree.parse(file.parent / include.get("file")).getroot())
    return root


def pieces(root):
    return [geom for geom in root.iter("geom") if geom.get("class") in ZONES]


def move_up(height_m):
    return in_world(lambda root: [geom.set("pos", f"0 0 {height_m}") for geom in pieces(root)])


def take_visual_mesh(root):
    """The control: MuJoCo silently uses the convex hull of a mesh."""
    for visual, first, *others in [frame for frame in root.iter("frame") if is_of_wall(frame)]:
        first.set("mesh", visual.get("mesh"))
        drop(root, others)


def is_of_wall(frame):
    """Whether it is of one visual mesh and of collision shapes: things have many meshes, gravel has no shapes."""
    return len(frame) > 1 and sum(geom.get("class") == "cave_visual" for geom in frame) == 1


def drop(root, geoms):
    for parent in list(root.iter()):
        for geom in [child for child in parent if child in geoms]:
            parent.remove(geom)


def drop_largest_piece(root):
    sizes = {
        mesh.get("name"): np.ptp(np.fromstring(mesh.get("vertex"), sep=" ").reshape(-1, 3), axis=0).prod()
        for mesh in root.iter("mesh")
        if mesh.get("vertex")
    }
    drop(root, [max(pieces(root), key=lambda geom: sizes[geom.get("mesh")])])


def drop_chunk(root):
    drop(root, [next(root.iter("frame"))])


def forget_friction(root):
    for geom in root.iter("geom"):
        geom.attrib.pop("friction", None)


def flip(package):
    for file in package.glob("assets/*.msh"):
        content = bytearray(file.read_bytes())
        faces = np.frombuffer(content, "<i4", 4)[3]
        corners = np.frombuffer(content, "<i4", offset=len(content) - 12 * faces).reshape(-1, 3)
        content[len(content) - 12 * faces :] = corners[:, ::-1].tobytes()
        file.write_bytes(content)


def cut_power(package):
    tree = ElementTree.parse(package / "cave_rover.xml")
    tree.getroot().find(".//default/velocity").set("forcerange", "-1 1")
    tree.write(package / "cave_rover.xml")


FAULTS = {
    "the visual mesh as collision, for balls": ("balls", in_world(take_visual_mesh), "of 1000 balls are"),
    "the visual mesh as collision, for rays": ("rays", in_world(take_visual_mesh), "is not convex"),
    "pieces that stand out": ("balls", move_up(0.1), "in the air"),
    "pieces that lie too deep": ("balls", move_up(-0.1), "too deep"),
    "pieces that stand out, for rays": ("rays", move_up(0.1), "in the open"),
    "a hole": ("rays", in_world(drop_largest_piece), "rays"),
    "a mesh inside out": ("rays", flip, "faces the rock"),
    "a missing chunk": ("rays", in_world(drop_chunk), "is not closed"),
    "no friction": ("drive", in_world(forget_friction), "friction under the rover is"),
    "wheels in the rock": ("drive", move_up(-0.1), "m into the rock"),
    "a rover without power": ("drive", cut_power, "gets no further"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_faulty_package_fails(fault, package, tmp_path):
    name, change, message = FAULTS[fault]
    faulty = tmp_path / "package"
    shutil.copytree(package, faulty)
    change(faulty)
    code, said = verify(name, faulty, package.with_name("cave"))
    assert code == 1 and message in said, said


def exported(folder, cave, *options):
    """Another package of a cave."""
    settings = [word for option in options for word in ("--option", f"mujoco.{option}")]
    export = ["export", str(cave), "--target", "mujoco", "--quiet", "--output", str(folder), *settings]
    subprocess.run([sys.executable, "-m", "plume", *export], check=True)
    return folder


def driven(package):
    """Where the rover is after a drive, and its model."""
    model = mujoco.MjModel.from_xml_path(str(package / "cave_rover.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    data.ctrl[:] = 3.0
    mujoco.mj_step(model, data, 2000)
    return data.qpos.copy(), model


def test_without_visuals_the_rover_drives_the_same_trajectory(package, tmp_path):
    bare = exported(tmp_path / "bare", package.with_name("cave"), "visuals=false")
    (there, model), (as_before, full) = driven(bare), driven(package)
    assert np.array_equal(there, as_before)
    collides = full.geom_contype > 0
    assert model.ngeom < full.ngeom and np.sum(model.geom_contype > 0) == np.sum(collides)
    assert model.ntex == 0 and not any(bare.glob("assets/*"))


def test_short_things_have_no_hull(package, tmp_path):
    few = exported(tmp_path / "few", package.with_name("cave"), "least_hull_m=0.3")
    (_, model), (_, full) = driven(few), driven(package)
    kept, hulls = ({geom for geom in names(of) if geom.endswith("_hull")} for of in (model, full))
    longest_m = {geom: 2 * full.geom_aabb[full.geom(geom).id, 3:].max() for geom in hulls}
    # The axes of MuJoCo's box are those of inertia, along which a stone may be longer than along its own, by a quarter at most.
    assert kept and all(longest_m[geom] > 0.3 * 0.75 for geom in kept)
    assert hulls - kept and all(longest_m[geom] < 0.3 * 1.25 for geom in hulls - kept)


def names(model):
    return [model.geom(geom).name for geom in range(model.ngeom)]


def test_a_model_of_a_part_has_the_chunks_of_that_part(package, tmp_path):
    part = tmp_path / "package"
    shutil.copytree(package, part)
    index = json.loads((part / "chunks.json").read_text())
    start = driven(package)[1].key(0).qpos[:3]
    near = [chunk["file"] for chunk in index["chunks"] if is_around(chunk["bounds_m"], start)]
    includes = "".join(f'<include file="{file}"/>' for file in [index["shared"], *near])
    (part / "cave_world.xml").write_text(f"<mujoco>{includes}</mujoco>")
    there, model = driven(part)
    as_before, full = driven(package)
    assert 0 < len(near) < len(index["chunks"]) and model.ngeom < full.ngeom
    assert np.array_equal(there, as_before), "it does not leave the part"


def is_around(bounds_m, point, reach_m=4.0):
    low, high = np.array(bounds_m)
    return bool(np.all(low - reach_m <= point) and np.all(point <= high + reach_m))
