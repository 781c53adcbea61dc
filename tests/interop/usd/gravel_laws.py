"""What the gravel of a stage of ours must be: instancers that are only drawn."""

import json

import package as packages
from pxr import Usd, UsdPhysics, UsdSemantics


def gravel_is_labelled_and_only_drawn(stage):
    for instancer in packages.gravel(stage):
        path = instancer.GetPath()
        labels = UsdSemantics.LabelsAPI(instancer, "class").GetLabelsAttr().Get() or []
        if list(labels) != ["gravel"]:
            yield f"{path} is labelled {list(labels)}"
        if any(prim.HasAPI(UsdPhysics.CollisionAPI) for prim in Usd.PrimRange(instancer.GetPrim())):
            yield f"{path} collides"
        counts = {len(attribute.Get() or []) for attribute in arrays_of(instancer)}
        shapes = len(instancer.GetPrototypesRel().GetTargets())
        if len(counts) != 1 or max(instancer.GetProtoIndicesAttr().Get() or [0]) >= shapes:
            yield f"{path} has arrays of {sorted(counts)} stones of {shapes} shapes"


def arrays_of(instancer):
    return [
        instancer.GetProtoIndicesAttr(),
        instancer.GetPositionsAttr(),
        instancer.GetOrientationsAttr(),
        instancer.GetScalesAttr(),
    ]


def gravel_is_counted(package, root):
    """Each chunk of gravel has the stones that the manifest counts, and no other chunk has any."""
    manifest = json.loads((package / "manifest.json").read_text(encoding="utf-8"))
    counted = {chunk["name"]: chunk["gravel"] for chunk in manifest["chunks"] if "gravel" in chunk}
    stage = packages.open_stage(root)
    instancers = packages.gravel(stage)
    found = {one.GetPrim().GetParent().GetName(): len(one.GetProtoIndicesAttr().Get()) for one in instancers}
    for chunk in sorted(counted.keys() | found.keys()):
        if found.get(chunk) != counted.get(chunk):
            yield f"{chunk} has {found.get(chunk)} stones, not {counted.get(chunk)}"


LAWS = [gravel_is_labelled_and_only_drawn]
FILE_LAWS = [gravel_is_counted]
