"""What a stage of ours must be, and no validator asks."""

import json
from itertools import pairwise
from pathlib import PurePosixPath

import body_laws
import drawing_laws
import gravel_laws
import numpy as np
import package as packages
from pxr import Ar, Gf, Sdf, Usd, UsdGeom, UsdLux, UsdPhysics, UsdSemantics, UsdShade, UsdUtils

PARTS = {"floor", "wall", "ceiling"}


def broken(stage):
    """A line for every law that the composed stage breaks."""
    return [f"{law.__name__}: {message}" for law in LAWS for message in failures(law, stage)]


def failures(law, stage):
    try:
        return list(law(stage))
    except IndexError as error:
        return [f"an index is out of range: {error}"]


def broken_files(package, root):
    """A line for every law that the files break."""
    return [f"{law.__name__}: {message}" for law in FILE_LAWS for message in law(package, root)]


def units_are_metres_and_kilograms_z_up(stage):
    found = (
        UsdGeom.GetStageMetersPerUnit(stage),
        UsdPhysics.GetStageKilogramsPerUnit(stage),
        UsdGeom.GetStageUpAxis(stage),
    )
    if found != (1.0, 1.0, "Z"):
        yield f"{found}"
    if stage.GetDefaultPrim().GetPath() != "/World":
        yield f"the default prim is {stage.GetDefaultPrim().GetPath()}"


def visual_meshes_have_every_array(stage):
    if not packages.meshes(stage, "Visual"):
        yield "there is no visual mesh"
    for mesh in packages.meshes(stage, "Visual"):
        points = mesh.GetPointsAttr().Get() or []
        st = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("st")
        arrays = {
            "points": points,
            "normals": mesh.GetNormalsAttr().Get() or [],
            "st": (st.Get() if st else None) or [],
        }
        for name, array in arrays.items():
            if not len(array) or len(array) != len(points):
                yield f"{mesh.GetPath()} has {len(array)} {name} for {len(points)} points"
        if st and st.GetInterpolation() != UsdGeom.Tokens.vertex:
            yield f"{mesh.GetPath()} has st per {st.GetInterpolation()}"
        if mesh.GetSubdivisionSchemeAttr().Get() != UsdGeom.Tokens.none:
            yield f"{mesh.GetPath()} is subdivided"


def extents_are_those_of_the_points(stage):
    for mesh in packages.meshes(stage, "Visual") + packages.colliders(stage):
        extent = np.asarray(mesh.GetExtentAttr().Get())
        points = np.asarray(mesh.GetPointsAttr().Get() or [])
        if len(points) and not np.array_equal(extent, [points.min(0), points.max(0)]):
            yield f"{mesh.GetPath()}"


# Triangles of a pebble or a dripstone that may be on such an edge, of which it has only dozens.
FEW = 4


def normals_are_on_the_side_the_triangles_face(stage):
    for mesh in packages.meshes(stage, "Visual"):
        indices = np.asarray(mesh.GetFaceVertexIndicesAttr().Get() or []).reshape(-1, 3)
        points, normals = np.asarray(mesh.GetPointsAttr().Get() or []), np.asarray(mesh.GetNormalsAttr().Get() or [])
        if len(normals) != len(points) or indices.max(initial=-1) >= len(points):
            yield f"{mesh.GetPath()} has no normals to compare"
            continue
        a, b, c = (points[indices[:, corner]] for corner in range(3))
        across = np.einsum("ij,ij->i", np.cross(b - a, c - a), normals[indices].sum(1))
        # On an edge sharper than the triangles a few may, more so on coarse levels, which keep the normals of full detail;
        # a mesh inside out has them all.
        if (across <= 0).sum() > max(0.05 * len(across), FEW):
            yield f"{mesh.GetPath()} has {(across <= 0).sum()} triangles that face against their normals"


def colliders_are_apart(stage):
    for mesh in packages.meshes(stage, "Visual"):
        if mesh.GetPrim().HasAPI(UsdPhysics.CollisionAPI):
            yield f"{mesh.GetPath()} is visual and collides"
    for mesh in packages.colliders(stage):
        prim = mesh.GetPrim()
        if (
            not prim.HasAPI(UsdPhysics.CollisionAPI)
            or not UsdPhysics.CollisionAPI(prim).GetCollisionEnabledAttr().Get()
        ):
            yield f"{mesh.GetPath()} does not collide"
        approximation = UsdPhysics.MeshCollisionAPI(prim).GetApproximationAttr().Get()
        is_piece = prim.GetName() != "Collision" or packages.is_of_instance(mesh)
        if approximation != (UsdPhysics.Tokens.convexHull if is_piece else UsdPhysics.Tokens.none):
            yield f"{mesh.GetPath()} is approximated by {approximation}"
        if is_piece and not is_convex(packages.triangles(mesh)):
            yield f"{mesh.GetPath()} is not convex"
        if mesh.GetPurposeAttr().Get() != UsdGeom.Tokens.guide:
            yield f"{mesh.GetPath()} is drawn"


def is_convex(corners):
    """Whether no corner is outside of a face by more than a millimetre, which is more than 32 bits lose."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    heights = corners.reshape(-1, 3) @ normals.T - np.einsum("ij,ij->i", corners[:, 0], normals)
    return heights.max(initial=-np.inf) < 1e-3


def physics_is_whole(stage):
    colliders = packages.colliders(stage)
    if not colliders:
        return
    merged = packages.merged(stage)
    rough = {mesh.GetPath().GetPrefixes()[2] for mesh in colliders if mesh.GetPrim() != merged}
    shared = [mesh.GetPrim().GetPrimInPrototype() for mesh in colliders if packages.is_of_instance(mesh)]
    hard = {prim.GetPath().GetPrefixes()[0] for prim in shared}
    for thing in packages.instances(stage):
        if thing.GetPrototype().GetPath() in hard:
            rough.add(thing.GetPath().GetPrefixes()[2])
        elif not merged or packages.is_body(thing):
            yield f"{thing.GetPath()} does not collide"
    wanted = {chunk.GetPath() for chunk in packages.chunks(stage) if not packages.is_gravel(chunk)}
    if merged:
        wanted = {thing.GetPath().GetPrefixes()[2] for thing in packages.bodies(stage)}
    if rough != wanted:
        yield f"{len(rough)} chunks collide, not {len(wanted)}"
    scenes = [UsdPhysics.Scene(prim) for prim in stage.TraverseAll() if prim.IsA(UsdPhysics.Scene)]
    if len(scenes) != 1:
        yield f"{len(scenes)} physics scenes"
    for scene in scenes:
        if (
            scene.GetGravityDirectionAttr().Get() != Gf.Vec3f(0, 0, -1)
            or not scene.GetGravityMagnitudeAttr().Get() >= 0
        ):
            yield "gravity does not point down"
    for mesh in colliders:
        material, _ = UsdShade.MaterialBindingAPI(mesh).ComputeBoundMaterial("physics")
        if not material or not material.GetPrim().HasAPI(UsdPhysics.MaterialAPI):
            yield f"{mesh.GetPath()} has no physics material"
        elif UsdPhysics.MaterialAPI(material).GetDynamicFrictionAttr().Get() is None:
            yield f"{mesh.GetPath()} has no friction"


def the_cave_has_labels(stage):
    world = UsdSemantics.LabelsAPI(stage.GetPrimAtPath("/World"), "class").GetLabelsAttr().Get() or []
    if "cave" not in world:
        yield f"/World is labelled {list(world)}"
    for thing in packages.instances(stage):
        classes = UsdSemantics.LabelsAPI(thing, "class").GetLabelsAttr().Get() or []
        if len(classes) != 1 or not thing.GetName().startswith(f"{classes[0]}_"):
            yield f"{thing.GetPath()} is labelled {list(classes)}"
    for mesh in packages.meshes(stage, "Visual"):
        if packages.is_of_instance(mesh):
            continue
        labels = {}
        for subset in UsdGeom.Subset.GetAllGeomSubsets(mesh):
            label = UsdSemantics.LabelsAPI(subset, "class").GetLabelsAttr().Get() or [None]
            labels[label[0]] = np.asarray(subset.GetIndicesAttr().Get() or [], dtype=np.int64)
        if not labels or not set(labels) <= PARTS:
            yield f"{mesh.GetPath()} has faces labelled {sorted(map(str, labels))}"
            continue
        corners = packages.triangles(mesh)
        up = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2]
        if (up[labels.get("floor", [])] < 0).any() or (up[labels.get("ceiling", [])] > 0).any():
            yield f"{mesh.GetPath()} has floor that faces down or ceiling that faces up"


def robots_can_start(stage):
    poses = packages.spawns(stage)
    if not len(poses):
        yield "there is no start pose"
    for number, pose in enumerate(poses):
        if not np.allclose(pose[:3, 2], [0, 0, 1], atol=1e-6):
            yield f"spawn_{number} does not stand upright"


def lights_shine(stage):
    for prim in stage.TraverseAll():
        if prim.IsA(UsdLux.SphereLight) and not UsdLux.SphereLight(prim).GetIntensityAttr().Get() > 0:
            yield f"{prim.GetPath()}"


def the_stage_tells_where_it_is_from(stage):
    world = stage.GetPrimAtPath("/World")
    if not {"name", "identifier", "version"} <= set(world.GetAssetInfo()):
        yield f"assetInfo has {sorted(world.GetAssetInfo())}"
    if "seed" not in (world.GetCustomDataByKey("plume:recipe") or ""):
        yield "customData has no recipe"


LAWS = [
    units_are_metres_and_kilograms_z_up,
    visual_meshes_have_every_array,
    extents_are_those_of_the_points,
    normals_are_on_the_side_the_triangles_face,
    colliders_are_apart,
    physics_is_whole,
    the_cave_has_labels,
    robots_can_start,
    lights_shine,
    the_stage_tells_where_it_is_from,
    *body_laws.LAWS,
    *drawing_laws.LAWS,
    *gravel_laws.LAWS,
]


def paths_are_relative_and_lead_somewhere(package, root):
    layers, assets, unresolved = UsdUtils.ComputeAllDependencies(Sdf.AssetPath(str(root)))
    for path in unresolved:
        yield f"{path} does not exist"
    for layer in layers:
        for path in [*layer.GetCompositionAssetDependencies(), *layer.GetExternalAssetDependencies()]:
            written = PurePosixPath(path)
            if written.is_absolute() or ".." in written.parts or "://" in path:
                yield f"{path} in {PurePosixPath(layer.identifier).name} is absolute or climbs out"
    inside = package.resolve()
    for path in [layer.realPath for layer in layers] + list(assets):
        file = Ar.SplitPackageRelativePathOuter(str(path))[0]
        if not PurePosixPath(file).is_relative_to(inside):
            yield f"{PurePosixPath(file).name} lies outside of the package"


def images_are_written_as_relative_paths(package, root):
    stage = packages.open_stage(root)
    for prim in packages.prims(stage):
        image = UsdShade.Shader(prim).GetInput("file") if prim.IsA(UsdShade.Shader) else None
        if not image:
            continue
        path = image.Get()
        if not path or not path.path.startswith("./"):
            yield f"{prim.GetPath()} names {path}"
        elif not path.resolvedPath:
            yield f"{prim.GetPath()} names {path.path}, which does not exist"


BESIDE = {"README.md", "LICENSE.md", "manifest.json", "instances.json", "stations.csv"}


def every_file_is_used(package, root):
    if root.suffix == ".usdz":
        return
    layers, assets, _ = UsdUtils.ComputeAllDependencies(Sdf.AssetPath(str(root)))
    used = {PurePosixPath(path) for path in [layer.realPath for layer in layers] + list(assets)}
    for file in sorted(package.resolve().rglob("*")):
        if file.is_file() and file not in used and file.name not in BESIDE:
            yield f"{file.name} is used by nothing"


def the_manifest_lists_the_files(package, root):
    listed = set(json.loads((package / "manifest.json").read_text())["files"])
    there = {file.relative_to(package).as_posix() for file in package.rglob("*") if file.is_file()}
    yield from sorted(listed ^ (there - {"manifest.json"}))


def payloads_stay_closed_and_open_alone(package, root):
    stage = packages.open_stage(root, Usd.Stage.LoadNone)
    if packages.meshes(stage, "Visual"):
        yield "a mesh is there before any payload is loaded"
    for chunk in packages.chunks(stage):
        if UsdGeom.ModelAPI(chunk).GetExtentsHint() is None:
            yield f"{chunk.GetPath()} has no size while it is closed"
            return
    chunks = packages.chunks(stage)
    for chunk in [*chunks[:2], *chunks[-1:]]:
        stage.Load(chunk.GetPath())
        if not packages.meshes(stage, "Visual") and not packages.gravel(stage):
            yield f"{chunk.GetPath()} does not open alone"
        elif not has_the_size_it_tells(chunk):
            yield f"{chunk.GetPath()} has another size when it is open"
        stage.Unload(chunk.GetPath())
        if packages.meshes(stage, "Visual") or packages.gravel(stage):
            yield f"{chunk.GetPath()} does not close"


def has_the_size_it_tells(chunk):
    """Whether the hint of a chunk is the box of its mesh, or within the boxes of its things, which are turned with them."""
    hint = UsdGeom.ModelAPI(chunk).GetExtentsHint()
    if visual := chunk.GetChild("Visual"):
        return UsdGeom.Mesh(visual).GetExtentAttr().Get() == hint
    boxes = UsdGeom.BBoxCache(Usd.TimeCode.Default(), [UsdGeom.Tokens.default_])
    box = boxes.ComputeRelativeBound(chunk, chunk.GetParent()).ComputeAlignedRange()
    low, high = np.asarray(hint)
    return (np.asarray(box.GetMin()) <= low + 1e-3).all() and (np.asarray(box.GetMax()) >= high - 1e-3).all()


def levels_get_coarser(package, root):
    stage = packages.open_stage(root)
    for chunk in packages.chunks(stage):
        faces = [count_faces(chunk) for _ in packages.levels_of(chunk)]
        if not faces or 0 in faces or any(finer <= coarser for finer, coarser in pairwise(faces)):
            yield f"{chunk.GetPath()} has levels of {faces} faces"


def count_faces(chunk):
    """Of the visual mesh of a chunk, and of those of its things; or of its gravel."""
    if gravel := chunk.GetChild("Gravel"):
        return faces_of_gravel(UsdGeom.PointInstancer(gravel))
    visual, things = chunk.GetChild("Visual"), [prim for prim in Usd.PrimRange(chunk) if prim.IsInstance()]
    meshes = [visual] if visual else [thing.GetChild("Visual") for thing in things]
    return sum(len(UsdGeom.Mesh(mesh).GetFaceVertexCountsAttr().Get() or []) for mesh in meshes)


def faces_of_gravel(instancer):
    """Of the stones that the level shows."""
    stage, hidden = instancer.GetPrim().GetStage(), set(instancer.GetInvisibleIdsAttr().Get() or [])
    shapes = [UsdGeom.Mesh(stage.GetPrimAtPath(path)) for path in instancer.GetPrototypesRel().GetTargets()]
    faces = [len(shape.GetFaceVertexCountsAttr().Get()) for shape in shapes]
    indices = instancer.GetProtoIndicesAttr().Get()
    return sum(faces[shape] for number, shape in enumerate(indices) if number not in hidden)


FILE_LAWS = [
    levels_get_coarser,
    paths_are_relative_and_lead_somewhere,
    images_are_written_as_relative_paths,
    every_file_is_used,
    the_manifest_lists_the_files,
    payloads_stay_closed_and_open_alone,
    *body_laws.FILE_LAWS,
    *gravel_laws.FILE_LAWS,
]
