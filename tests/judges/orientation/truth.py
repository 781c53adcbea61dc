"""What the marker is like, and whether a reader has seen it so.

A judge hands in what it read of each file, in the frame of the scene: metres, Z up, texture coordinates from the lower
left. It must agree with `marker.json`, which no exporter has touched; and where the marker was spoiled, it must say so, if it
can see such a thing at all.
"""

import json
import os
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

PLACE_M = 1e-4
TURN = 2e-3  # OBJ rounds normals to four decimals, MuJoCo and Blender keep them with 16 bits or fewer
UV = 1e-4
# Corners of the marker are eighths of a metre, so that rounding tells them apart.
GRID = 1000

# The fault of a spoiled marker, and the attribute that tells.
SPOILS = {
    "mirrored": "position",
    "turned": "position",
    "reversed_winding": "winding",
    "upside_down_images": "uv",
    "negated_normals": "normal",
    "other_handedness": "handedness",
}


class Complaint(Exception):
    """What is wrong with what was read."""


def require(truth, complaint):
    if not truth:
        raise Complaint(complaint)


@dataclass
class Triangles:
    """Corners of n triangles: positions (n, 3, 3), and what else the reader sees."""

    position: np.ndarray
    normal: np.ndarray | None = None
    uv: np.ndarray | None = None
    tangent: np.ndarray | None = None

    @classmethod
    def of_mesh(cls, faces, position, normal=None, uv=None, tangent=None):
        """From attributes per vertex."""
        faces = np.asarray(faces).reshape(-1, 3)
        pick = [None if rows is None else np.asarray(rows, dtype=np.float64)[faces] for rows in (normal, uv, tangent)]
        return cls(np.asarray(position, dtype=np.float64)[faces], *pick)

    def turned(self, matrix):
        """In another frame: what points somewhere is multiplied by a rotation."""

        def turn(vectors):
            return None if vectors is None else vectors @ np.asarray(matrix, dtype=np.float64).T

        tangent = self.tangent
        if tangent is not None:
            tangent = np.concatenate([turn(tangent[..., :3]), tangent[..., 3:]], axis=-1)
        return Triangles(turn(self.position), turn(self.normal), self.uv, tangent)

    def sees(self):
        attributes = {"position", "winding"}
        attributes |= {name for name in ("normal", "uv") if getattr(self, name) is not None}
        return attributes | ({"handedness"} if self.tangent is not None else set())


def joined(parts):
    """One array of triangles of several meshes, with the attributes that all of them have."""
    parts = list(parts)
    require(parts, "there is no mesh")
    rows = [[getattr(part, name) for part in parts] for name in ("position", "normal", "uv", "tangent")]
    return Triangles(*(None if any(part is None for part in row) else np.concatenate(row) for row in rows))


def upper_left(uv):
    """Texture coordinates of a format that counts from the upper left, and back."""
    return np.column_stack([np.asarray(uv)[:, 0], 1 - np.asarray(uv)[:, 1]])


Z_UP_FROM_Y_UP = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]


def marker(path):
    corners = json.loads(Path(path).read_text())["triangles"]
    return Triangles(*(np.array([[corner[name] for corner in triangle] for triangle in corners])
                       for name in ("position", "normal", "uv", "tangent")))  # fmt: skip


def keys(triangles):
    """For each triangle its corners as a key that knows the winding but not which corner is first, and that first corner."""
    for number, corners in enumerate(np.rint(triangles.position * GRID).astype(int).tolist()):
        first = min(range(3), key=lambda corner: corners[corner])
        order = [(first + step) % 3 for step in range(3)]
        yield number, tuple(tuple(corners[corner]) for corner in order), order


def faults(found, truth):
    """What of the attributes is not as it should be."""
    there = {key: (number, order) for number, key, order in keys(truth)}
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
    return said | differences(found, truth, pairs)


def differences(found, truth, pairs):
    """Attributes that differ at the corners of triangles that are in their place."""
    if not pairs:
        return set()
    mine = np.array([[(number, corner) for corner in order] for number, order, _, _ in pairs])
    theirs = np.array([[(number, corner) for corner in order] for _, _, number, order in pairs])

    def off(name, tolerance, part=slice(None)):
        if getattr(found, name) is None:
            return False
        here = getattr(found, name)[mine[..., 0], mine[..., 1]][..., part]
        there = getattr(truth, name)[theirs[..., 0], theirs[..., 1]][..., part]
        return not np.abs(here - there).max() <= tolerance

    tests = {
        "position": off("position", PLACE_M),
        "normal": off("normal", TURN),
        "uv": off("uv", UV),
        "tangent": off("tangent", TURN, slice(0, 3)),
        "handedness": off("tangent", 0, slice(3, 4)),
    }
    return {name for name, is_off in tests.items() if is_off}


def check(reader, patterns, read, sample, package):
    """One reader on one package: unspoiled, and spoiled in each way. Gives what it sees."""

    def seen(variant):
        home = sample / variant / package
        return joined(read(path) for path in sorted({path for pattern in patterns for path in home.glob(pattern)}))

    found = seen("marker")
    said = faults(found, marker(sample / "marker" / "marker.json"))
    require(not said, f"{reader} on {package}: not as in the scene: {', '.join(sorted(said))}")
    for fault, attribute in SPOILS.items():
        if attribute in found.sees():
            said = faults(seen(f"marker_{fault}"), marker(sample / "marker" / "marker.json"))
            require(attribute in said, f"{reader} on {package}: did not notice {fault}, but {sorted(said)}")
    return ", ".join(sorted(found.sees()))


def judge(sample, readers):
    """`readers` has for each name how to read a file, and by patterns which files of which packages. Gives praise."""
    praises = []
    for reader, (read, files) in readers.items():
        sights = {}
        for package in sorted(path.name for path in (sample / "marker").iterdir() if path.is_dir()):
            patterns = files.get(package, files.get("*", []))
            if any(path for pattern in patterns for path in (sample / "marker" / package).glob(pattern)):
                sights.setdefault(check(reader, patterns, read, sample, package), []).append(package)
        praises += [f"{reader} sees {sight} of {', '.join(packages)}" for sight, packages in sights.items()]
    require(praises, f"there is nothing in {sample} that {', '.join(readers)} could read")
    return "; ".join(praises)


def run(readers):
    """Judges the samples in the folder that the command line names; praise goes to stdout, all else to stderr."""
    with os.fdopen(os.dup(1), "w") as stdout:
        os.dup2(2, 1)
        try:
            print(judge(Path(sys.argv[1]), readers), file=stdout)
        except Complaint as complaint:
            sys.exit(f"error: {complaint}")
