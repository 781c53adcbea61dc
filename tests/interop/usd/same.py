"""Reads a USD package with two versions of USD and compares the results.

    same.py PACKAGE_DIR OTHER_PYTHON

Every prim with its type and schemas and every array of it, at every level of detail, must be the same to the bit.
"""

import hashlib
import subprocess

import numpy as np
import package as packages
from package import require, run
from pxr import Usd


def verify(package, python=None):
    here = digest(packages.root_layer(package))
    if python is None:
        return here
    there = subprocess.run([python, __file__, package], capture_output=True, text=True)
    require(there.returncode == 0, f"the other USD fails: {there.stderr}")
    seen, other = here.split(": "), there.stdout.strip().split(": ")
    require(seen[0] != other[0], f"both are {seen[0]}")
    require(seen[1] == other[1], f"{here} and {there.stdout}")
    return f"{seen[0]} and {other[0]} see the same {seen[1]}"


def digest(root):
    stage = packages.open_stage(root)
    seen, prims, values = hashlib.sha256(), 0, 0
    for chunk in [None, *packages.chunks(stage)]:
        for _ in packages.levels_of(chunk) if chunk else [None]:
            known = {}
            for prim in Usd.PrimRange(chunk) if chunk else stage.TraverseAll():
                prims += 1
                values += update(seen, prim, prim.GetPath())
                if prim.IsInstance():
                    seen.update(inside(prim, known))
    version = ".".join(str(part) for part in Usd.GetVersion()[1:])
    return f"USD {version}: {prims} prims, {values} values, SHA-256 {seen.hexdigest()[:16]}"


def inside(instance, known):
    """The digest of what is below an instance, which is the same for all of its prototype."""
    prototype = instance.GetPrototype().GetPath()
    if prototype not in known:
        seen = hashlib.sha256()
        for prim in packages.below(instance):
            update(seen, prim, prim.GetPath().MakeRelativePath(instance.GetPath()))
        known[prototype] = seen.digest()
    return known[prototype]


def update(seen, prim, path):
    """Adds a prim to a digest; gives the number of its attributes."""
    seen.update(f"{path} {prim.GetTypeName()} {prim.GetAppliedSchemas()}".encode())
    attributes = prim.GetAuthoredAttributes()
    for attribute in attributes:
        seen.update(attribute.GetName().encode() + bits(attribute.Get()))
    return len(attributes)


def bits(value):
    array = np.asarray(value)
    return array.tobytes() if array.dtype.kind in "fiu" else getattr(value, "path", str(value)).encode()


if __name__ == "__main__":
    run(verify)
