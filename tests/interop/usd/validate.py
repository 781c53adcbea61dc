"""Opens a USD package with the validators of USD and of NVIDIA, and holds it to what neither looks at.

    validate.py PACKAGE_DIR

The root layer and every chunk alone, at every level of detail, must pass without a message but those of two rules. The last
line of a success gives the numbers of prims and triangles.
"""

import logging
from contextlib import contextmanager

import laws
import package as packages
from package import Failure, run
from pxr import Sdf, Usd, UsdValidation

# THE EXCEPTION. Both rules only warn, and only of points whose place, normal and texture coordinates are all equal. Where a
# chart of the texture touches itself in a point there are two of these. Welding them silences the two rules and makes
# `ManifoldChecker` fail (tried), so nobody can please all three. In their stead the law `twins_stand_only_at_pinches`
# allows such points there and nowhere else.
ACCEPTED = {"WeldChecker", "IndexedPrimvarChecker"}


def verify(package):
    root = packages.root_layer(package)
    stage = packages.open_stage(root)
    messages = []
    for level in levels(stage):
        select(stage, level)
        messages += [f"{root.name}, {level}: {message}" for message in usd_messages(stage)]
        messages += [f"{root.name}, {level}: {message}" for message in laws.broken(stage)]
    select(stage, "LOD0")
    with switched_off(stage, copies(stage)):
        messages += [f"{root.name}: {message}" for message in nvidia_messages(stage)]
    for layer in sorted(package.glob("chunks/*.usdc")):
        messages += [f"{layer.name}: {message}" for message in usd_messages(packages.open_stage(layer))]
    messages += laws.broken_files(package, root)
    if messages:
        raise Failure("\n".join(sorted(set(messages))))
    visuals = packages.meshes(stage, "Visual")
    faces = sum(laws.count_faces(chunk) for chunk in packages.chunks(stage))
    things = len(packages.instances(stage))
    version = ".".join(str(part) for part in Usd.GetVersion()[1:])
    prims = len(list(stage.TraverseAll()))
    return f"USD {version}: {prims} prims, {len(visuals)} visual meshes, {things} things, {faces} triangles, nothing that a validator refuses"


def levels(stage):
    sets = [chunk.GetVariantSet("LOD").GetVariantNames() for chunk in packages.chunks(stage)]
    return sorted(set().union(*sets)) or ["LOD0"]


def select(stage, level):
    """Chooses a level for every chunk, or the coarsest that it has; in the session layer, not in the package."""
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        for chunk in packages.chunks(stage):
            variants = chunk.GetVariantSet("LOD")
            names = variants.GetVariantNames()
            variants.SetVariantSelection(level if level in names else max(names, default=""))


def copies(stage):
    """Every instance but the first of each prototype: what is below them is the same, and takes minutes."""
    seen, others = set(), []
    for thing in packages.instances(stage):
        prototype = thing.GetPrototype().GetPath()
        if prototype in seen:
            others.append(thing.GetPath())
        seen.add(prototype)
    return others


@contextmanager
def switched_off(stage, paths):
    """Makes prims inactive, in the session layer and not in the package."""
    layer = Sdf.Layer.CreateAnonymous()
    with Sdf.ChangeBlock():
        for path in paths:
            Sdf.CreatePrimInLayer(layer, path).active = False
    session = stage.GetSessionLayer()
    session.subLayerPaths.append(layer.identifier)
    yield
    session.subLayerPaths.remove(layer.identifier)


def usd_messages(stage):
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    errors = UsdValidation.ValidationContext(validators).Validate(stage)
    return [f"{error.GetName()}: {error.GetMessage()}" for error in errors]


def nvidia_messages(stage):
    """What NVIDIA's rules say; their engine goes through the levels by itself."""
    logging.disable()
    from usd_validation_nvidia import ValidationEngine

    issues = ValidationEngine(init_rules=True).validate(stage).issues()
    refused = [issue for issue in issues if not accepted(issue)]
    return [
        f"{issue.rule.__name__ if issue.rule else 'no rule'}: {issue.message} {issue.at or ''}" for issue in refused
    ]


def accepted(issue):
    return issue.rule is not None and issue.rule.__name__ in ACCEPTED and issue.severity.name == "WARNING"


if __name__ == "__main__":
    run(verify)
