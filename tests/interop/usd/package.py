"""A USD package as the checks see it."""

import json
import sys
from pathlib import Path

import numpy as np
from pxr import Tf, Usd, UsdGeom, UsdPhysics


class Failure(Exception):
    """What is wrong with a package."""


def require(truth, message):
    if not truth:
        raise Failure(message)


def root_layer(package):
    """The one layer of the package that a user opens."""
    found = sorted([*package.glob("*.usda"), *package.glob("*.usdz")])
    require(len(found) == 1, f"expected one .usda or .usdz in {package.name}, found {[file.name for file in found]}")
    return found[0]


def open_stage(path, load=Usd.Stage.LoadAll):
    return Usd.Stage.Open(str(path), load)


def prims(stage):
    """Every prim, and those of one instance of each prototype."""
    seen = set()
    for prim in stage.TraverseAll():
        yield prim
        if prim.IsInstance() and prim.GetPrototype().GetPath() not in seen:
            seen.add(prim.GetPrototype().GetPath())
            yield from below(prim)


def below(instance):
    """The prims of an instance without itself."""
    yield from list(Usd.PrimRange(instance, Usd.TraverseInstanceProxies(Usd.PrimAllPrimsPredicate)))[1:]


def meshes(stage, name):
    """Every mesh prim with this name; of instances of one prototype only one."""
    return [UsdGeom.Mesh(prim) for prim in prims(stage) if prim.IsA(UsdGeom.Mesh) and prim.GetName() == name]


def colliders(stage):
    """Every mesh that bodies touch: the collision mesh of each chunk, its convex pieces, or one mesh for all that does not move;
    and a hull of each prototype."""
    return [UsdGeom.Mesh(prim) for prim in prims(stage) if is_collider(prim)]


def merged(stage):
    """The collision mesh of all that does not move, if there is one."""
    return stage.GetPrimAtPath("/World/Collision")


def is_collider(prim):
    return prim.IsA(UsdGeom.Mesh) and "Collision" in str(prim.GetPath()).split("/")


def instances(stage):
    """The things, each an instance of a prototype."""
    return [prim for prim in stage.TraverseAll() if prim.IsInstance()]


def gravel(stage):
    """The instancers of gravel, which is only drawn; one for each chunk that is open."""
    found = [chunk.GetChild("Gravel") for chunk in chunks(stage)]
    return [UsdGeom.PointInstancer(prim) for prim in found if prim]


def bodies(stage):
    """The things that move when they are pushed."""
    return [thing for thing in instances(stage) if is_body(thing)]


def is_body(prim):
    return prim.HasAPI(UsdPhysics.RigidBodyAPI)


def hide_bodies(stage):
    """Switches them off in the layer that is edited."""
    for thing in bodies(stage):
        stage.OverridePrim(thing.GetPath()).SetActive(False)


def listed_things(package):
    """The things of the list that every package has, if there are any."""
    file = package / "instances.json"
    return json.loads(file.read_text(encoding="utf-8"))["things"] if file.is_file() else []


def is_of_instance(mesh):
    return mesh.GetPrim().IsInstanceProxy()


def chunks(stage):
    return stage.GetPrimAtPath("/World/Chunks").GetAllChildren()


def is_gravel(chunk):
    return chunk.GetName().startswith("gravel_")


def levels_of(chunk):
    """Selects each level of detail of a chunk in turn, in the session layer and not in the package."""
    levels = chunk.GetVariantSet("LOD")
    stage = chunk.GetStage()
    for level in levels.GetVariantNames():
        with Usd.EditContext(stage, stage.GetSessionLayer()):
            levels.SetVariantSelection(level)
        yield level


def triangles(mesh):
    """Corners in metres in the frame of the mesh, shape (triangle, corner, xyz)."""
    points = np.asarray(mesh.GetPointsAttr().Get() or [], dtype=np.float64).reshape(-1, 3)
    return points[np.asarray(mesh.GetFaceVertexIndicesAttr().Get() or [], dtype=np.int64).reshape(-1, 3)]


def places(things):
    """Where things are in metres in the frame of the stage, shape (thing, xyz)."""
    cache = UsdGeom.XformCache()
    found = [cache.GetLocalToWorldTransform(thing).ExtractTranslation() for thing in things]
    return np.array(found, dtype=np.float64).reshape(-1, 3)


def rock(stage, with_bodies):
    """Corners of all colliders in metres in the frame of the stage, shape (triangle, corner, xyz); of what moves as it starts."""
    cache, hulls = UsdGeom.XformCache(), {}
    found = [triangles(UsdGeom.Mesh(prim)) for prim in stage.TraverseAll() if is_collider(prim)]
    for thing in [thing for thing in instances(stage) if with_bodies or not is_body(thing)]:
        prototype = thing.GetPrototype().GetPath()
        if prototype not in hulls:
            hulls[prototype] = [triangles(UsdGeom.Mesh(prim)) for prim in below(thing) if is_collider(prim)]
        world_from_thing = np.asarray(cache.GetLocalToWorldTransform(thing))
        found += [hull @ world_from_thing[:3, :3] + world_from_thing[3, :3] for hull in hulls[prototype]]
    return np.concatenate(found)


def spawns(stage):
    """Poses, shape (spawn, 4, 4), column vectors."""
    prims = stage.GetPrimAtPath("/World/Spawns").GetChildren()
    cache = UsdGeom.XformCache()
    return np.array([np.asarray(cache.GetLocalToWorldTransform(prim)).T for prim in prims])


def run(verify):
    """Runs a check on the package that the command line names; its summary goes to stdout, failures to stderr."""
    try:
        print(verify(Path(sys.argv[1]), *sys.argv[2:]))
    except (Failure, Tf.ErrorException) as failure:
        sys.exit(str(failure))
