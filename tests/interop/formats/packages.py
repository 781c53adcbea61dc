"""What readers see of packages: triangles in the frame of the scene, whatever the format.

The frame is that of the scene: metres, right-handed, Z up, texture coordinates from the lower left.
"""

import os
import re
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

Z_UP_FROM_Y_UP = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]


class Failure(Exception):
    """Faults of the loaded mesh."""


def require(holds, message):
    if not holds:
        raise Failure(message)


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


def is_drawn(name):
    """Whether a mesh or a file of this name is what cameras see in full detail."""
    return not (name.startswith("UCX_") or "collision" in name.lower() or re.search(r"_lod(s$|[1-9])", name.lower()))


@dataclass
class Reader:
    """A program that reads some files of some packages."""

    name: str
    # Gives the triangles of a file.
    read: callable
    # Patterns of the files by name of the package; `*` is any other.
    files: dict
    # Gives the number of materials in what was read last, and fails on them; if the reader sees any.
    look: callable = None

    def files_of(self, package):
        patterns = self.files.get(package.name, self.files.get("*", []))
        return sorted({path for pattern in patterns for path in package.glob(pattern) if is_drawn(path.stem)})


def packages_in(folder):
    """Folders that could be packages. A cave folder has a dot in its name."""
    return sorted(path for path in folder.iterdir() if path.is_dir() and "." not in path.name)


def run(verify, readers):
    """Checks the folder that the command line names, and ends the program. The summary goes to stdout, all else to stderr."""
    stdout = os.dup(1)
    os.dup2(2, 1)
    try:
        os.write(stdout, f"{verify(Path(sys.argv[1]), readers)}\n".encode())
        code = 0
    except Failure as failure:
        print(f"error: {failure}", file=sys.stderr)
        code = 1
    sys.stdout.flush()
    sys.stderr.flush()
    # Blender's module crashes during interpreter shutdown.
    os._exit(code)
