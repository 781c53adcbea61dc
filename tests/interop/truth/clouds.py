"""The clouds, read by plyfile, pypcd4 and laspy.

- All three are the same points.
- Points are on triangles of the PLY, with their normals, labels and chunks; things are those of `instances.json`.
- Any run of triangles has as many points as its area is due, and within triangles they are everywhere.
"""

import json

import laspy
import numpy as np
import plyfile
import pypcd4
from failure import require

ON_MESH_M = 1e-3
# Steps of coordinates in LAS.
STEP_M = 1e-4
# Points so near an edge that another triangle may be as near.
MOST_ODD = 2e-3
RUN = 500


def verify(package, world):
    told = json.loads((package / "truth.json").read_text(encoding="utf-8"))["files"]
    per_m2 = {entry["per_m2"] for entry in told if entry["file"].startswith("cloud.")}
    require(len(per_m2) == 1, f"the clouds have {per_m2} points per square metre")
    points, normals, codes = of_ply(package / "cloud.ply")
    check_alike("PCD", of_pcd(package / "cloud.pcd"), (points, normals, codes), 0.0)
    check_alike("LAS", of_las(package / "cloud.las", codes[:, 0]), (points, normals, codes), STEP_M)
    away, faces, nearest = world.nearest(points.astype(np.float64))
    require(away.max() < ON_MESH_M, f"a point is {away.max()} m from the mesh")
    odd = {
        "normals": (normals * world.normals[faces]).sum(axis=1) < 0.999,
        "labels": codes[:, 0] != world.labels[faces],
        "chunks": codes[:, 1] != world.chunks[faces],
    }
    for name, wrong in odd.items():
        require(
            wrong.mean() < MOST_ODD, f"{wrong.sum()} of {len(points)} points have other {name} than their triangles"
        )
    check_things(world, codes)
    check_density(world, faces, nearest, per_m2.pop())
    return f"{len(points)} points"


def of_ply(path):
    rows = plyfile.PlyData.read(path)["vertex"]
    stack = lambda names: np.stack([rows[name] for name in names], axis=1)  # noqa: E731 - said once
    return stack(["x", "y", "z"]), stack(["nx", "ny", "nz"]), stack(["label", "chunk", "thing"]).astype(int)


def of_pcd(path):
    rows = pypcd4.PointCloud.from_path(path)
    stack = lambda names: np.stack([rows.pc_data[name] for name in names], axis=1)  # noqa: E731 - said once
    normals = stack(["normal_x", "normal_y", "normal_z"])
    return stack(["x", "y", "z"]), normals, stack(["label", "chunk", "thing"]).astype(int)


def of_las(path, labels):
    rows = laspy.read(path)
    header = rows.header
    require(
        np.allclose([header.mins, header.maxs], [rows.xyz.min(axis=0), rows.xyz.max(axis=0)], atol=STEP_M),
        "the header of the LAS has other bounds",
    )
    require((np.asarray(rows.classification) == np.where(labels == 1, 2, 1)).all(), "the LAS has other classes")
    normals = np.stack([rows[name] for name in ("NormalX", "NormalY", "NormalZ")], axis=1)
    return rows.xyz, normals, np.stack([rows[name] for name in ("label", "chunk", "thing")], axis=1).astype(int)


def check_alike(name, found, expected, within_m):
    require(len(found[0]) == len(expected[0]), f"the {name} has {len(found[0])} points, the PLY {len(expected[0])}")
    require(np.allclose(found[0], expected[0], rtol=0, atol=within_m), f"the {name} has points elsewhere")
    for own, other in zip(found[1:], expected[1:], strict=True):
        require(np.array_equal(own, other), f"the {name} has other normals or codes")


def check_things(world, codes):
    label, chunk, thing = codes.T
    require(thing.max(initial=0) <= len(world.things), f"there is no thing {thing.max(initial=0)}")
    require(np.array_equal(thing > 0, label > 3), "a thing has the label of a zone, or the wall that of a thing")
    for number, of_chunk, of_label in np.unique(codes[thing > 0][:, [2, 1, 0]], axis=0):
        told, said = world.things[number - 1], (world.chunk_names[of_chunk], world.names[of_label])
        require(
            (told["chunk"], told["class"]) == said, f"thing {number} is {told['class']} in {told['chunk']}, not {said}"
        )


def check_density(world, faces, nearest, per_m2):
    due = per_m2 * world.areas
    found = np.bincount(faces, minlength=len(due))
    starts = np.arange(0, len(due), RUN)
    due, found = np.add.reduceat(due, starts), np.add.reduceat(found, starts)
    # Points may be counted for a neighbour of their triangle, which is in another run.
    worst = np.abs(found - due).max()
    require(worst < 5 + 0.02 * due.max(), f"a run of {RUN} triangles has {worst:.1f} points too many or too few")
    a, b, c = (world.vertices[world.faces[faces, n]] for n in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    weights = np.stack(
        [np.linalg.norm(np.cross(p - nearest, q - nearest), axis=1) for p, q in ((b, c), (c, a), (a, b))]
    )
    means = (weights / np.maximum(areas, 1e-12)).mean(axis=1)
    spread = (weights / np.maximum(areas, 1e-12)).std(axis=1)
    # That of an even spread is the root of 1/18.
    is_even = np.abs(means - 1 / 3).max() < 0.02 and np.abs(spread - np.sqrt(1 / 18)).max() < 0.02
    require(is_even, f"points are not spread evenly over triangles: {means}, {spread}")
