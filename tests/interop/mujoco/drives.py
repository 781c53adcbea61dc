"""Holds certificates of caves to drives of the rover of their MuJoCo packages.

    drives.py [--passages N] CAVE_DIR PACKAGE_DIR CERTIFICATE.json [...]

Certificates are those of `plume certify --robot rover`. The rover is put down at the start of

- the path to the furthest station;
- the paths through passages that are called go or marginal, each way; at most N of each class, those with the steepest first;
- passages that are called no-go, along the straight line between their stations.

What is called go must be driven to its end: anything else is a failure. A table of what was said and what came of it is printed.
"""

import argparse
import json
from collections import Counter
from pathlib import Path

import numpy as np
import plume
from certified import drive
from package import require
from rover import Rover
from scipy.spatial.transform import Rotation

LEAST_M = 0.5  # shorter paths are left out


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--passages", type=int, default=1000)
    arguments.add_argument("caves", nargs="+", type=Path)
    given = arguments.parse_args()
    table = Counter()
    wrong = []
    for cave, package, certificate in zip(given.caves[::3], given.caves[1::3], given.caves[2::3], strict=True):
        wrong += hold(cave, package, json.loads(certificate.read_text(encoding="utf-8")), given.passages, table)
    for said in ("go", "marginal", "no-go"):
        print(f"{said:9} driven {table[said, True]:5}  not driven {table[said, False]:5}")
    require(not wrong, f"{len(wrong)} drives failed that were called go: {'; '.join(wrong[:5])}")


def hold(cave, package, certificate, most, table):
    """Counts what was said and what came of it; the drives that failed although they were called go."""
    rover = Rover.of(package)
    wrong = []
    for said, name, poses in drives(cave, certificate, most):
        fault, passed_m, length_m = drive(rover, poses)
        table[said, fault is None] += 1
        if said == "go" and fault is not None:
            wrong.append(f"{cave.name} {name}: {fault} after {passed_m:.1f} of {length_m:.1f} m")
            print(wrong[-1], flush=True)
    print(f"{cave.name}: {dict(table)}", flush=True)
    return wrong


def drives(cave, certificate, most):
    """What is said about a path, its name and its poses as in TUM files."""
    if certificate["route"]:
        yield "go", f"to {certificate['route']['to']}", posed(certificate["route"]["path"])
    with plume.open(cave) as opened:
        ids = [node["id"] for node in opened.graph.to_dict()["nodes"]]
        places = dict(zip(ids, opened.graph.positions, strict=True))
    found = {"go": [], "marginal": [], "no-go": []}
    for passage in certificate["passages"]:
        for way, ends in (("there", ("from", "to")), ("back", ("to", "from"))):
            verdict = passage[way]
            ends = [passage[end] for end in ends]
            path = verdict["path"] or straight(*[places[end] for end in ends])
            if len(path) > 1 and length_m(path) >= LEAST_M:
                found[verdict["class"]].append((steepest(path), f"{ends[0]}..{ends[1]}", posed(path)))
    for said, paths in found.items():
        paths.sort(key=lambda one: (-one[0], one[1]))
        yield from ((said, name, poses) for _, name, poses in paths[:most])


def straight(one, other):
    """A way along a line between two stations, which hang in the air."""
    count = max(int(np.linalg.norm(other - one) / 0.1), 2)
    heading_deg = np.degrees(np.arctan2(other[1] - one[1], other[0] - one[0]))
    return [[*point, heading_deg, 0.0, 0.0] for point in np.linspace(one, other, count)]


def length_m(path):
    return np.linalg.norm(np.diff(np.array(path)[:, :2], axis=0), axis=1).sum()


def steepest(path):
    """Rise over half a metre."""
    path = np.array(path)
    along = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(path[:, :2], axis=0), axis=1))])
    at = np.arange(0, along[-1], 0.5)
    return float(np.abs(np.diff(np.interp(at, along, path[:, 2]))).max(initial=0.0))


def posed(path):
    """Poses as in TUM files."""
    path = np.array(path)
    rotations = Rotation.from_euler("ZYX", path[:, 3:] * [1, -1, 1], degrees=True)
    return np.column_stack([np.zeros(len(path)), path[:, :3], rotations.as_quat()])


if __name__ == "__main__":
    main()
