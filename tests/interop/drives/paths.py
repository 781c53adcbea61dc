"""The paths of which a certificate says something."""

from typing import NamedTuple

import numpy as np

LEAST_M = 0.5  # shorter paths are left out
SPACING_M = 0.1
CLASSES = ("go", "marginal", "no-go")


class Path(NamedTuple):
    """What is said of it, and its poses: x, y, z in metres, heading, climb and lean in degrees."""

    said: str
    name: str
    poses: np.ndarray


def paths_of(certificate, graph):
    """The path to the furthest station, if there is one, and those through all passages, either way."""
    furthest = certificate["route"]
    to_furthest = [Path("go", f"to {furthest['to']}", np.array(furthest["path"]))] if furthest else []
    stations = {node["id"]: np.array([node["coordinates"][axis] for axis in "xyz"]) for node in graph["nodes"]}
    through = []
    for passage in certificate["passages"]:
        for way, start, end in (("there", "from", "to"), ("back", "to", "from")):
            verdict, ends = passage[way], [passage[start], passage[end]]
            poses = np.array(verdict["path"] or straight(*[stations[station] for station in ends]))
            through.append(Path(verdict["class"], f"{ends[0]}..{ends[1]}", poses))
    return to_furthest, [path for path in through if length_m(path.poses) >= LEAST_M]


def some(paths, most):
    """The steepest of those that are called go, as many as that; and of either other class as many as that, by lot."""
    dice = np.random.default_rng(1)
    go, *others = [[path for path in paths if path.said == said] for said in CLASSES]
    go.sort(key=lambda path: -np.abs(path.poses[:, 4]).max())
    for named in others:
        dice.shuffle(named)
    return [path for named in (go, *others) for path in named[:most]]


def straight(one, other):
    """A path along the line between two stations, which hang in the air."""
    heading_deg = np.degrees(np.arctan2(other[1] - one[1], other[0] - one[0]))
    points = np.linspace(one, other, max(int(np.linalg.norm(other - one) / SPACING_M), 2))
    return [[*point, heading_deg, 0.0, 0.0] for point in points]


def length_m(poses):
    return np.linalg.norm(np.diff(poses[:, :2], axis=0), axis=1).sum()


def poses_called_go(certificate):
    """The poses of all paths that are called go."""
    verdicts = [passage[way] for passage in certificate["passages"] for way in ("there", "back")]
    paths = [verdict["path"] for verdict in verdicts if verdict["class"] == "go"]
    return np.concatenate([*paths, *([certificate["route"]["path"]] if certificate["route"] else [])])
