"""What a stage of ours must be for its things to move, and no validator asks: which are bodies, and of which mass."""

import numpy as np
import package as packages
import trimesh
from pxr import Gf, UsdGeom, UsdPhysics

PLACE_M = 1e-6
SHARE = 1e-4  # single precision, and the hull in it


def only_things_are_bodies(stage):
    for prim in packages.prims(stage):
        if packages.is_body(prim) and not prim.IsInstance():
            yield f"{prim.GetPath()} is a rigid body"


def bodies_have_the_inertia_of_their_hulls(stage):
    hulls = {}
    for thing in packages.bodies(stage):
        mass = UsdPhysics.MassAPI(thing)
        if not thing.HasAPI(UsdPhysics.MassAPI) or not mass.GetMassAttr().Get() > 0:
            yield f"{thing.GetPath()} has no mass"
            continue
        prototype = thing.GetPrototype().GetPath()
        if prototype not in hulls:
            [hull] = [prim for prim in packages.below(thing) if packages.is_collider(prim)]
            corners = packages.triangles(UsdGeom.Mesh(hull))
            hulls[prototype] = trimesh.Trimesh(**trimesh.triangles.to_kwargs(corners))
        if fault := wrong_inertia(mass, hulls[prototype], scale_of(thing)):
            yield f"{thing.GetPath()} has another {fault} than its hull"


def scale_of(thing):
    return Gf.Transform(UsdGeom.Xformable(thing).GetLocalTransformation()).GetScale()[0]


def wrong_inertia(mass, hull, scale):
    """What differs from a solid hull of the same mass, as trimesh computes it."""
    size = np.ptp(hull.vertices, axis=0).max()
    center = np.array(mass.GetCenterOfMassAttr().Get())
    if np.abs(center - hull.center_mass).max() > SHARE * size:
        return "centre of mass"
    axes = np.array(Gf.Matrix3d(Gf.Rotation(Gf.Quatd(mass.GetPrincipalAxesAttr().Get())))).T
    tensor = axes @ np.diag(mass.GetDiagonalInertiaAttr().Get()) @ axes.T
    # Of a density of 1 in its own size.
    expected = hull.moment_inertia / hull.volume * mass.GetMassAttr().Get() * scale**2
    return "inertia" if np.abs(tensor - expected).max() > SHARE * np.trace(expected) else None


LAWS = [only_things_are_bodies, bodies_have_the_inertia_of_their_hulls]


def things_are_those_of_the_list(package, root):
    """As many things as are listed, those that are movable as bodies, each at its place."""
    stage = packages.open_stage(root)
    things = {thing.GetName(): thing for thing in packages.instances(stage)}
    listed = {f"{thing['class']}_{thing['id']}": thing for thing in packages.listed_things(package)}
    if things.keys() != listed.keys():
        yield f"{len(things)} things, {len(listed)} are listed; not both: {sorted(things.keys() ^ listed.keys())[:3]}"
        return
    for (name, thing), at in zip(things.items(), packages.places(things.values()), strict=True):
        wanted = listed[name]
        if packages.is_body(thing) != wanted["movable"]:
            yield f"{name} is {'not ' if wanted['movable'] else ''}movable"
        elif wanted["movable"]:
            mass = UsdPhysics.MassAPI(thing).GetMassAttr().Get() or 0
            if abs(mass - wanted["mass_kg"]) > SHARE * wanted["mass_kg"]:
                yield f"{name} has {mass} kg, {wanted['mass_kg']} are listed"
        if np.abs(at - wanted["position"]).max() > PLACE_M:
            yield f"{name} is at {at}, not at {wanted['position']}"


FILE_LAWS = [things_are_those_of_the_list]
