"""Compares the things of a MuJoCo package with its list of them.

    things.py PACKAGE_DIR

MuJoCo must see every thing of `instances.json` and no other: a geom to be seen and one to be touched, each at its place, of
meshes that things share. What is movable is a body with a free joint, of the listed mass, which stays where it is when nothing
pushes it: after two seconds 95 of 100 have moved by less than a fifth of their width, and none has fallen out of the cave.
"""

import json

import mujoco
import numpy as np
from package import Wall, name_of, require, run

PLACE_M = 1e-5
MASS_SHARE = 1e-3  # masses have micrograms
DURATION_S = 2.0
CALM_SHARE = 0.95
MOVED_SHARE = 0.2


def verify(package):
    file = package / "instances.json"
    listed = json.loads(file.read_text())["things"] if file.is_file() else []
    name = name_of(package)
    model = mujoco.MjModel.from_xml_path(str(package / f"{name}.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    names = {f"{name}_{thing['class']}_{thing['id']}" for thing in listed}
    geoms = {model.geom(geom).name for geom in range(model.ngeom)}
    touched = {geom.removesuffix("_hull") for geom in geoms if geom.endswith("_hull")}
    require(
        touched == names,
        f"{len(touched)} things to touch, {len(names)} are listed; not both: {sorted(touched ^ names)[:3]}",
    )
    require(names <= geoms, f"{len(names - geoms)} things cannot be seen, among them {sorted(names - geoms)[:3]}")
    check_places(model, data, name, listed)
    meshes = {int(model.geom(f"{thing}_hull").dataid[0]) for thing in names}
    # A mesh of MuJoCo has its scale in it.
    shapes = {(thing["prototype"], thing["scale"]) for thing in listed}
    require(
        len(meshes) == len(shapes), f"{len(names)} things of {len(shapes)} shapes and sizes have {len(meshes)} meshes"
    )
    movable = [thing for thing in listed if thing["movable"]]
    require(model.nbody == 1 + len(movable), f"{model.nbody - 1} bodies, {len(movable)} things are movable")
    moved = check_movable(package, model, data, name, movable) if movable else ""
    return f"MuJoCo: {len(names)} things share {len(meshes)} hulls{moved}"


def check_places(model, data, name, listed):
    """MuJoCo puts the frame of a mesh into its centre, and tells where that is in the frame of the prototype."""
    for thing in listed:
        for suffix in ("", "_hull"):
            geom = model.geom(f"{name}_{thing['class']}_{thing['id']}{suffix}").id
            mesh = model.geom_dataid[geom]
            own = np.zeros(9)
            mujoco.mju_quat2Mat(own, model.mesh_quat[mesh])
            turn = data.geom_xmat[geom].reshape(3, 3) @ own.reshape(3, 3).T
            origin = data.geom_xpos[geom] - turn @ model.mesh_pos[mesh]
            off_m = np.abs(origin - thing["position"]).max()
            require(off_m < PLACE_M, f"{thing['class']} {thing['id']}{suffix} is {off_m:.4f} m from its place")


def check_movable(package, model, data, name, movable):
    bodies = [model.body(f"{name}_{thing['class']}_{thing['id']}").id for thing in movable]
    masses = np.array([thing["mass_kg"] for thing in movable])
    wrong = np.abs(model.body_mass[bodies] - masses) > MASS_SHARE * masses
    require(not wrong.any(), f"{wrong.sum()} bodies have another mass than listed")
    require((model.body_inertia[bodies] > 0).all(), "a body has no inertia")
    widths_m = np.array([2 * model.geom_rbound[model.body_geomadr[body] + 1] for body in bodies])
    starts = data.xpos[bodies].copy()
    mujoco.mj_step(model, data, round(DURATION_S / model.opt.timestep))
    require(np.isfinite(data.qpos).all(), "the simulation diverged")
    low_m = Wall(package).bounds[0][2]
    require((data.xpos[bodies][:, 2] > low_m).all(), "a stone has fallen out of the cave")
    shares = np.linalg.norm(data.xpos[bodies] - starts, axis=1) / widths_m
    calm = (shares < MOVED_SHARE).mean()
    require(calm >= CALM_SHARE, f"only {calm:.1%} of the stones stay where they are")
    return (
        f"; of {len(movable)} movable ones {calm:.1%} stay, half of them within {np.median(shares):.1%} of their width"
    )


if __name__ == "__main__":
    run(verify)
