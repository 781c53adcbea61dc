"""Compiles an exported MuJoCo package with MuJoCo's own compiler, in every way that a user brings it into a model.

    compile.py PACKAGE_DIR|PACKAGE.mjz

Each model of a folder must compile as it is, and the cave also where a model of the user's includes it, attaches it from
another folder, twice, or attaches it in Python; what the user has set must stay. MuJoCo must not warn once. An archive must
compile from Python's reader and from MuJoCo's own, whatever it is called.
"""

import shutil
import sys
import tempfile
import warnings
from pathlib import Path

import mujoco
import numpy as np

STEPS = 200

# A user's model that takes the names a careless cave would take, and sets what a careless cave would change.
USER = """<mujoco model="cave">
  <compiler angle="radian"/>
  <option timestep="0.004" gravity="0 0 -3.7" integrator="RK4" cone="pyramidal" impratio="3"/>
  <visual><map znear="0.02" zfar="7"/><headlight ambient="0.7 0.6 0.5"/><global offwidth="333"/></visual>
  <default>
    <geom condim="4" contype="2" conaffinity="4" group="1" friction="0.1"/>
    <default class="visual"/><default class="collision"/><default class="floor"/><default class="wall"/>
  </default>
  <asset><texture name="rock" type="2d" builtin="flat" width="8" height="8"/><material name="rock" texture="rock"/>{asset}</asset>
  {include}
  <worldbody>
    <light name="light"/><camera name="camera"/><site name="spawn_0"/>
    <geom name="floor" type="plane" size="1 1 1" pos="0 0 -500" material="rock"/>
    <body name="rover" pos="0 0 -490"><freejoint name="free"/><geom name="wall" size="0.2"/></body>
    {attach}
  </worldbody>
</mujoco>
"""


def main(package):
    warnings.simplefilter("error", UserWarning)
    said = []
    mujoco.set_mju_user_warning(said.append)
    verdict = verify_archive(package) if package.is_file() else verify_folder(package)
    require(not said, f"MuJoCo warns: {said}")
    print(verdict)


def verify_archive(archive):
    with tempfile.TemporaryDirectory() as folder:
        renamed = Path(folder) / "another_name.mjz"
        shutil.copy(archive, renamed)
        for path in (archive, renamed):
            models = [mujoco.MjSpec.from_zip(str(path)).compile(), mujoco.MjSpec.from_file(str(path)).compile()]
            require(counts(models[0]) == counts(models[1]), "the two readers of archives see different models")
    return f"MuJoCo {mujoco.__version__}: {archive.name}: {counts(models[0])}"


def verify_folder(package):
    name = cave_name(package)
    cave = compiled(package / f"{name}.xml")
    verify_names(cave, name)
    verify_parts(cave, name)
    rover = compiled(package / "rover.xml")
    both = compiled(package / f"{name}_rover.xml")
    require(both.nkey == 1 and both.key(0).name == f"{name}_start", f"{name}_rover.xml has no keyframe {name}_start")
    require(both.nbody == cave.nbody + rover.nbody - 1, f"{name}_rover.xml is not the cave and the rover")
    verify_include(package, name, cave)
    verify_attach(package, name, cave)
    verify_attach_in_python(package, name, cave)
    return f"MuJoCo {mujoco.__version__}: {name}: {counts(cave)}; with the rover {counts(both)}"


def cave_name(package):
    worlds = list(package.glob("*_world.xml"))
    require(len(worlds) == 1, f"expected one *_world.xml in {package}, found {len(worlds)}")
    return worlds[0].name.removesuffix("_world.xml")


def compiled(path):
    """The model, after it has moved a little."""
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_step(model, data, STEPS)
    require(np.isfinite(data.qpos).all(), f"{path.name}: it flies to pieces")
    return model


def names(model):
    """Names of everything but the world, by kind."""
    kinds = ("body", "geom", "site", "cam", "light", "mesh", "mat", "tex", "hfield", "flex")
    texts = model.names.split(b"\0")
    starts = np.cumsum([0] + [len(text) + 1 for text in texts])
    by_start = {int(start): text.decode() for start, text in zip(starts, texts, strict=False)}
    return {kind: [by_start[int(at)] for at in getattr(model, f"name_{kind}adr")] for kind in kinds}


def verify_names(cave, name):
    for kind, found in names(cave).items():
        bad = [text for text in found if not text.startswith(f"{name}_") and text != "world"]
        require(not bad, f"{kind} without the prefix {name}_: {bad[:3]}")


def verify_parts(cave, name):
    seen, felt = cave.geom_group == 2, cave.geom_group == 3
    require((seen | felt).all(), "a geom of the cave is neither in group 2 nor in group 3")
    require(not (cave.geom_contype[seen] | cave.geom_conaffinity[seen]).any(), "wheels touch a visual mesh")
    require((cave.geom_contype[felt] > 0).all(), "a collision shape collides with nothing")
    require(felt.any() or cave.nflex > 0, "wheels touch nothing")
    require((cave.geom_matid[seen] >= 0).all(), "a visual mesh has no material")
    roles = [mujoco.mjtTextureRole.mjTEXROLE_RGB, mujoco.mjtTextureRole.mjTEXROLE_NORMAL]
    for role in [*roles, mujoco.mjtTextureRole.mjTEXROLE_ORM]:
        require((cave.mat_texid[:, int(role)] >= 0).all(), f"a material has no {role.name}")
    spaces = cave.tex_colorspace[cave.mat_texid[:, int(mujoco.mjtTextureRole.mjTEXROLE_RGB)]]
    require((spaces == int(mujoco.mjtColorSpace.mjCOLORSPACE_SRGB)).all(), "a base colour is not marked as sRGB")
    kinds = names(cave)
    spawns = [site for site in kinds["site"] if site.startswith(f"{name}_spawn_")]
    require(spawns, "there is no start pose")
    for spawn in spawns:
        look = cave.cam(f"{spawn}_camera").id
        require(f"{spawn}_camera" in kinds["cam"], f"{spawn} has no camera")
        lift = cave.cam_pos[look] - cave.site(spawn).pos
        require(abs(np.linalg.norm(lift) - 1.0) < 1e-3, f"the camera of {spawn} is not 1 m above it")
        ahead, back = rotation(cave.site(spawn).quat)[:, 0], rotation(cave.cam_quat[look])[:, 2]
        require(np.allclose(ahead, -back, atol=1e-3), f"the camera of {spawn} does not look along its x")


def rotation(quaternion):
    matrix = np.zeros(9)
    mujoco.mju_quat2Mat(matrix, quaternion)
    return matrix.reshape(3, 3)


def verify_include(package, name, cave):
    """Included files are searched next to the model, so the user's model is in a folder of links to the package."""
    with tempfile.TemporaryDirectory() as folder:
        for path in package.iterdir():
            (Path(folder) / path.name).symlink_to(path.resolve())
        user = Path(folder) / "user.xml"
        user.write_text(USER.format(include=f'<include file="{name}_world.xml"/>', asset="", attach=""))
        verify_user(compiled(user), cave, 1, "include")


def verify_attach(package, name, cave):
    world = (package / f"{name}_world.xml").resolve()
    asset = f'<model name="theirs" file="{world}"/>'
    attach = "".join(
        f'<frame pos="0 0 {height}"><attach model="theirs" prefix="{prefix}"/></frame>'
        for prefix, height in (("a_", 0), ("b_", 100))
    )
    with tempfile.TemporaryDirectory() as folder:
        user = Path(folder) / "user.xml"
        user.write_text(USER.format(include="", asset=asset, attach=attach))
        verify_user(compiled(user), cave, 2, "attach")


def verify_attach_in_python(package, name, cave):
    spec = mujoco.MjSpec.from_string(USER.format(include="", asset="", attach=""))
    world = mujoco.MjSpec.from_file(str(package / f"{name}_world.xml"))
    spec.attach(world, prefix="theirs_", frame=spec.worldbody.add_frame(pos=[0, 0, 50]))
    rover = mujoco.MjSpec.from_file(str(package / "rover.xml"))
    spec.attach(rover, prefix="mine_", frame=spec.worldbody.add_frame(pos=[0, 0, 60]))
    model = spec.compile()
    require(model.nu == 4, "the rover lost its drives")
    verify_user(model, cave, 1, "MjSpec.attach")


def verify_user(model, cave, times, way):
    """The cave is in the user's model as often as it should, and what the user has set is as it was."""
    alone = mujoco.MjModel.from_xml_string(USER.format(include="", asset="", attach=""))
    require(model.nmesh == times * cave.nmesh, f"{way}: {model.nmesh} meshes instead of {times * cave.nmesh}")
    for key in ("timestep", "gravity", "integrator", "cone", "impratio", "disableflags", "enableflags"):
        require(np.array_equal(getattr(model.opt, key), getattr(alone.opt, key)), f"{way} changes option {key}")
    for part, key in (("map", "znear"), ("map", "zfar"), ("headlight", "ambient"), ("global_", "offwidth")):
        same = np.array_equal(getattr(getattr(model.vis, part), key), getattr(getattr(alone.vis, part), key))
        require(same, f"{way} changes visual {part}.{key}")
    own = model.geom("wall")
    require(own.condim[0] == 4 and own.contype[0] == 2, f"{way} changes the user's geoms")
    theirs = set(names(cave)["geom"])
    for geom, text in enumerate(names(model)["geom"]):
        bare = text.removeprefix("a_").removeprefix("b_").removeprefix("theirs_")
        if bare in theirs:
            verify_same_geom(model.geom(geom), cave.geom(bare), way)


def verify_same_geom(geom, own, way):
    touched = ("condim", "friction", "priority") if own.contype[0] else ()
    for key in ("contype", "conaffinity", "group", *touched):
        require(np.array_equal(getattr(geom, key), getattr(own, key)), f"{way} changes {key} of {own.name}")


def counts(model):
    touched = int((model.geom_contype > 0).sum())
    return (
        f"{model.nbody} bodies, {model.nmesh} meshes, {touched} shapes, {model.nflex} flexes, {model.ntex} textures, "
        f"{model.nlight} lights, {model.ncam} cameras, {model.nu} drives"
    )


def require(condition, message):
    if not condition:
        fail(message)


def fail(message):
    sys.exit(f"compile.py: {message}")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        fail("usage: compile.py PACKAGE_DIR|PACKAGE.mjz")
    main(Path(sys.argv[1]))
