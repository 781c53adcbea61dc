"""What the marker is like, and whether readers have seen it so.

What they read must agree with `marker.json`, which no exporter has touched; and where the marker has a fault, they must say so,
if they can see such a thing at all.
"""

import json
from pathlib import Path

import numpy as np
from packages import Triangles, joined, packages_in, require

PLACE_M = 1e-4
TURN = 2e-3  # OBJ rounds normals to four decimals, MuJoCo and Blender keep them with 16 bits or fewer
UV = 1e-4
# Corners of the marker are multiples of an eighth of a metre, so that rounding distinguishes them.
GRID = 1000

# The fault of a marker, and the attribute that shows it.
FAULTS = {
    "mirrored": "position",
    "turned": "position",
    "reversed_winding": "winding",
    "upside_down_images": "uv",
    "negated_normals": "normal",
    "other_handedness": "handedness",
}


def truth(path):
    corners = json.loads(Path(path).read_text())["triangles"]
    return Triangles(*(np.array([[corner[name] for corner in triangle] for triangle in corners])
                       for name in ("position", "normal", "uv", "tangent")))  # fmt: skip


def keys(triangles):
    """For each triangle its corners as a key that knows the winding but not which corner is first, and that first corner."""
    for number, corners in enumerate(np.rint(triangles.position * GRID).astype(int).tolist()):
        first = min(range(3), key=lambda corner: corners[corner])
        order = [(first + step) % 3 for step in range(3)]
        yield number, tuple(tuple(corners[corner]) for corner in order), order


def faults(found, wanted):
    """What of the attributes is not as it should be."""
    there = {key: (number, order) for number, key, order in keys(wanted)}
    pairs, said = [], set()
    for number, key, order in keys(found):
        if key in there:
            pairs.append((number, order, *there.pop(key)))
        elif (key[0], key[2], key[1]) in there:
            said.add("winding")
        else:
            said.add("position")
    if there and "winding" not in said:
        said.add("position")
    return said | differences(found, wanted, pairs)


def differences(found, wanted, pairs):
    """Attributes that differ at the corners of triangles that are in their place."""
    if not pairs:
        return set()
    mine = np.array([[(number, corner) for corner in order] for number, order, _, _ in pairs])
    theirs = np.array([[(number, corner) for corner in order] for _, _, number, order in pairs])

    def off(name, tolerance, part=slice(None)):
        if getattr(found, name) is None:
            return False
        here = getattr(found, name)[mine[..., 0], mine[..., 1]][..., part]
        there = getattr(wanted, name)[theirs[..., 0], theirs[..., 1]][..., part]
        return not np.abs(here - there).max() <= tolerance

    tests = {
        "position": off("position", PLACE_M),
        "normal": off("normal", TURN),
        "uv": off("uv", UV),
        "tangent": off("tangent", TURN, slice(0, 3)),
        "handedness": off("tangent", 0, slice(3, 4)),
    }
    return {name for name, is_off in tests.items() if is_off}


def check(reader, sample, package):
    """Runs a reader on a package without faults and with each fault. Returns the attributes it sees."""
    wanted = truth(sample / "marker" / "marker.json")

    def seen(variant):
        return joined(map(reader.read, reader.files_of(sample / variant / package)))

    found = seen("marker")
    said = faults(found, wanted)
    require(not said, f"{reader.name} on {package}: not as in the scene: {', '.join(sorted(said))}")
    for fault, attribute in FAULTS.items():
        if attribute in found.sees():
            said = faults(seen(f"marker_{fault}"), wanted)
            require(attribute in said, f"{reader.name} on {package}: did not notice {fault}, but {sorted(said)}")
    return ", ".join(sorted(found.sees()))


def verify(sample, readers):
    """Every reader on every package that it reads. Gives summary."""
    summaries = []
    for reader in readers:
        sights = {}
        for package in packages_in(sample / "marker"):
            if reader.files_of(package):
                sights.setdefault(check(reader, sample, package.name), []).append(package.name)
        require(sights, f"there is nothing in {sample} that {reader.name} could read")
        summaries += [f"{reader.name} sees {sight} of {', '.join(packages)}" for sight, packages in sights.items()]
    return "; ".join(summaries)
