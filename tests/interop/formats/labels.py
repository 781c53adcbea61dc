"""Labels of PLY: their names are in the comments of the file, and every thing of `instances.json` has that of its class.

Gravel has the stones that the manifest counts, and a label of its own.

labels.py PLY_PACKAGE_DIR
"""

import json
import re
import sys
from pathlib import Path

import numpy as np
import plyfile
from packages import Failure, require
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

GRAVEL = "gravel"
ZONES = {"floor", "wall", "ceiling"}
# Of the things, those at whose middle the next point of a thing may be that of another on which it lies.
MOST_HIDDEN = 0.05
# By design a bolt is in the middle of each square of mesh.
HELD_BY = {"roof_mesh": "rock_bolt"}
SPACING_M = 0.05  # of the points on edges


def check(path):
    """Checks the labels of a file; gives the number of its things and of their classes."""
    data = plyfile.PlyData.read(path)
    names = names_of(data.comments, path.name)
    listed = things_of(path)
    stones = stones_of(path)
    classes = {thing["class"] for thing in listed} | ({GRAVEL} if stones else set())
    nameless = (ZONES | classes) - set(names.values())
    require(not nameless, f"{path.name} names no label for {sorted(nameless)}")
    for element in ("vertex", "face"):
        used = {int(label) for label in np.unique(data[element]["label"])}
        require(used <= set(names), f"{path.name} has labels without a name: {sorted(used - set(names))}")
        shown = {names[label] for label in used} - ZONES
        require(
            shown == classes, f"{path.name}: {element} labels are of {sorted(shown)}, the things of {sorted(classes)}"
        )
    check_faces(path, data)
    check_gravel(path, data, names, stones)
    if listed:
        check_places(path, data, names, listed)
    return len(listed) + stones, len(classes)


def names_of(comments, where):
    """Names by label."""
    found = [re.fullmatch(r"label (\d+) (\w+)", comment) for comment in comments]
    pairs = [(int(match[1]), match[2]) for match in found if match]
    names = dict(pairs)
    require(len(names) == len(pairs) == len(set(names.values())), f"{where}: two labels are one, or have one name")
    return names


def things_of(path):
    """Those of the package, or of the chunk if the file is one."""
    package, is_chunk = place_of(path)
    listed = package / "instances.json"
    things = json.loads(listed.read_text())["things"] if listed.is_file() else []
    return [thing for thing in things if not is_chunk or thing["chunk"] == path.stem]


def place_of(path):
    """The package of a file, and whether the file is a chunk."""
    is_chunk = path.parent.name == "chunks"
    return path.parent.parent if is_chunk else path.parent, is_chunk


def stones_of(path):
    """The number of stones of gravel in the package, or in the chunk if the file is one."""
    package, is_chunk = place_of(path)
    chunks = json.loads((package / "manifest.json").read_text())["chunks"]
    return sum(chunk.get("gravel", 0) for chunk in chunks if not is_chunk or chunk["name"] == path.stem)


def check_gravel(path, data, names, wanted):
    """The faces with its label are as many separate solids as there are stones."""
    is_gravel = np.array([names[int(label)] == GRAVEL for label in data["face"]["label"]])
    faces = np.vstack(data["face"]["vertex_indices"])[is_gravel]
    # Where a seam of the texture is, there are two vertices in one place.
    positions = np.column_stack([data["vertex"][axis] for axis in "xyz"])[faces.ravel()]
    _, points = np.unique(positions, axis=0, return_inverse=True)
    corners = points.reshape(-1, 3)
    edges = np.vstack([corners[:, [0, 1]], corners[:, [1, 2]]])
    size = points.max(initial=-1) + 1
    graph = coo_matrix((np.ones(len(edges)), edges.T), shape=(size, size))
    found = connected_components(graph, directed=False)[0] if size else 0
    require(found == wanted, f"{path.name} has {found} stones of gravel, not {wanted}")


def check_faces(path, data):
    """A face of a thing has the label of its corners, which it shares with nothing else."""
    corners = data["vertex"]["label"][np.vstack(data["face"]["vertex_indices"])]
    of_things = (corners > 3).any(axis=1)
    agree = (corners[of_things] == data["face"]["label"][of_things, None]).all()
    require(agree, f"{path.name}: faces of things have other labels than their corners")


def check_places(path, data, names, listed):
    """The point on an edge of a thing that is next to the middle of a thing has the label of its class."""
    points, labels = points_of_things(data)
    is_thing = np.array([names[int(label)] != GRAVEL for label in labels])
    points, labels = points[is_thing], labels[is_thing]
    _, nearest = cKDTree(points).query([thing["position"] for thing in listed])
    seen = zip(listed, (names[int(labels[index])] for index in nearest), strict=True)
    wrong = [thing for thing, name in seen if name not in (thing["class"], HELD_BY.get(thing["class"]))]
    share = len(wrong) / len(listed)
    require(
        share <= MOST_HIDDEN,
        f"{path.name}: {100 * share:.0f} % of the things have another label: {wrong[0]['class'] if wrong else ''}",
    )


def points_of_things(data):
    """Points on the edges of things, at most SPACING_M apart, and their labels: a rail has corners at its ends only."""
    vertex = data["vertex"]
    corners = np.column_stack([vertex[axis] for axis in "xyz"])
    faces = np.vstack(data["face"]["vertex_indices"])
    faces = faces[vertex["label"][faces[:, 0]] > 3]
    edges = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    from_m, to_m = corners[edges[:, 0]], corners[edges[:, 1]]
    counts = np.ceil(np.linalg.norm(to_m - from_m, axis=1) / SPACING_M).astype(int).clip(1)
    of_edge = np.repeat(np.arange(len(edges)), counts)
    step = np.arange(len(of_edge)) - np.repeat(np.cumsum(counts) - counts, counts)
    share = (step / counts[of_edge])[:, None]
    return from_m[of_edge] * (1 - share) + to_m[of_edge] * share, vertex["label"][edges[of_edge, 0]]


def verify(package):
    files = sorted(package.glob("**/*.ply"))
    require(files, f"there is no PLY in {package}")
    counts = [check(path) for path in files]
    return f"{sum(things for things, _ in counts)} things of {max(classes for _, classes in counts)} classes in {len(files)} files"


if __name__ == "__main__":
    try:
        print(verify(Path(sys.argv[1])))
    except Failure as failure:
        sys.exit(f"error: {failure}")
