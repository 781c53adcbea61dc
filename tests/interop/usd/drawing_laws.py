"""What a stage of ours must be to look right, and no validator asks: maps, texture coordinates, camera."""

from pathlib import PurePosixPath

import numpy as np
import package as packages
from pxr import UsdGeom, UsdShade

# Input of the surface, channel, end of the file name without its extension, colour space.
MAPS = {
    "diffuseColor": ("rgb", "_base_color", "sRGB"),
    "normal": ("rgb", "_normal", "raw"),
    "roughness": ("g", "_orm", "raw"),
    "occlusion": ("r", "_orm", "raw"),
}


def rock_has_maps(stage):
    """Each input of the surface reads the right channel of the right image in the right colour space."""
    for mesh in packages.meshes(stage, "Visual"):
        material, _ = UsdShade.MaterialBindingAPI(mesh).ComputeBoundMaterial()
        surface = material.ComputeSurfaceSource()[0] if material else None
        if not surface or surface.GetIdAttr().Get() != "UsdPreviewSurface":
            yield f"{mesh.GetPath()} has no UsdPreviewSurface"
            continue
        for name, wanted in MAPS.items():
            found = map_of(surface.GetInput(name))
            if found[0] != wanted[0] or not PurePosixPath(found[1]).stem.endswith(wanted[1]) or found[2] != wanted[2]:
                yield f"{mesh.GetPath()} has {name} from {found}, not {wanted}"


def map_of(shading_input):
    """Channel, file and colour space; empty where there is none."""
    sources = shading_input.GetConnectedSources()[0] if shading_input else []
    if not sources:
        return ("", "", "")
    image = UsdShade.Shader(sources[0].source.GetPrim())
    file, space = image.GetInput("file"), image.GetInput("sourceColorSpace")
    return (sources[0].sourceName, file.Get().path if file else "", space.Get() if space else "")


def st_covers_the_image(stage):
    """Texture coordinates are finite and not all the same."""
    for mesh in packages.meshes(stage, "Visual"):
        st = np.asarray(mesh.GetPrim().GetAttribute("primvars:st").Get() or np.zeros((1, 2)))
        if not np.isfinite(st).all() or np.ptp(st, axis=0).min() == 0:
            yield f"{mesh.GetPath()}"


def twins_stand_only_at_pinches(stage):
    """Points equal in everything are one point, unless it would pinch the surface: two fans without a common edge.

    Of full detail only: coarser levels keep its points, also where the pinch has gone; and small things are at a coarser level
    from the start.
    """
    for mesh in packages.meshes(stage, "Visual"):
        if "/things_" in str(mesh.GetPath()):
            continue
        if mesh.GetPrim().GetParent().GetVariantSet("LOD").GetVariantSelection() not in {"", "LOD0"}:
            continue
        indices = np.asarray(mesh.GetFaceVertexIndicesAttr().Get() or []).reshape(-1, 3)
        names = ["points", "normals", "primvars:st"]
        columns = [np.asarray(mesh.GetPrim().GetAttribute(name).Get() or []) for name in names]
        if len({len(column) for column in columns}) != 1 or indices.max(initial=0) >= len(columns[0]):
            continue  # reported by other laws and validators
        _, place = np.unique(np.concatenate(columns, axis=1), axis=0, return_inverse=True)
        twins = np.flatnonzero(np.bincount(place.ravel()) > 1)
        joined = sum(fans_touch(indices, place.ravel(), twin) for twin in twins)
        if joined:
            yield f"{mesh.GetPath()} has {joined} points twice"


def fans_touch(indices, place, twin):
    """Whether two of the points at `twin` have a neighbour in common, so that one point would do for both."""
    around = []
    for point in np.flatnonzero(place == twin):
        faces = indices[(indices == point).any(axis=1)]
        around += [*np.setdiff1d(place[faces], [twin])]
    return len(around) != len(set(around))


def the_view_is_from_the_start(stage):
    """The camera is upright above the first start pose, or the first picture shows the outside of the rock."""
    view = stage.GetPrimAtPath("/World/View")
    if not view or not view.IsA(UsdGeom.Camera):
        yield "/World/View is no camera"
        return
    pose = np.asarray(UsdGeom.XformCache().GetLocalToWorldTransform(view)).T
    starts = packages.spawns(stage)
    if len(starts) and np.linalg.norm(pose[:2, 3] - starts[0][:2, 3]) > 1:
        yield "/World/View is not over spawn_0"
    if pose[2, 1] < 0.999:
        yield "/World/View is tilted"


LAWS = [rock_has_maps, st_covers_the_image, twins_stand_only_at_pinches, the_view_is_from_the_start]
