"""Ways and tasks, held to shortest paths of SciPy, to the floor, and to rays marched through its cells.

- Lengths of `geodesic.npz` are at least those of an independent shortest path over the same cells, which knows no directions, and at
  most `LONGER` times as long with few exceptions; every cell is reached.
- Episodes have the fields that `PointNavDatasetV1` of habitat-lab passes on (NavigationEpisode, NavigationGoal, ShortestPathPoint), in
  its frame: a robot looks along its path, which is over the floor and as long as it says, and about as long as the independent one.
- `tasks.csv` has the same episodes in the frame of the other files.
- `search.csv` has every thing of these classes, with the nearest cell.
- From the places of `coverage.json` every cell is seen along a straight line, sampled at a quarter of a cell.
"""

import csv
import gzip
import json

import numpy as np
from failure import require
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

SEED = 1
# What headings of a whole robot make longer: where it cannot turn on the spot, it drives on until it can.
LONGER, LONGER_M = 1.15, 3.0
MOST_LONGER = 0.02
# A smoothed path cuts the corners of one in eight directions.
OCTILE = 1.0824
NEAR_M = 0.3
SEEN = 2000
MOST_UNSEEN = 0.005
EPISODE = {
    "episode_id": str, "scene_id": str, "start_position": list, "start_rotation": list, "info": dict, "goals": list,
    "shortest_paths": list, "start_room": type(None),
}  # fmt: skip
POINT = {"position", "rotation", "action"}


class Ways:
    """The cells of `geodesic.npz`, and a graph of them."""

    def __init__(self, package, floor):
        arrays = np.load(package / "geodesic.npz")
        self.cell, self.at, self.from_start = arrays["cell"], arrays["position"], arrays["from_start"]
        self.goal, self.to_goal = arrays["goal"], arrays["to_goal"]
        require(len(self.cell) > 0, "the robot has no cell")
        require(len(np.unique(self.cell)) == len(self.cell), "a cell of the robot is there twice")
        places = np.column_stack([floor.centre_m[self.cell], floor.z[self.cell]])
        require(np.allclose(self.at, places, atol=1e-4), "cells of the robot are not on those of the floor")
        self.tree = cKDTree(self.at)
        stride = max(round(0.1 / floor.side_m), 1) * floor.side_m
        pairs = self.tree.query_pairs(2.5 * stride, output_type="ndarray")
        along = np.abs(self.at[pairs[:, 0]] - self.at[pairs[:, 1]])
        pairs = pairs[along[:, :2].max(axis=1) < 1.1 * stride]
        lengths = np.linalg.norm(self.at[pairs[:, 0]] - self.at[pairs[:, 1]], axis=1)
        self.graph = coo_matrix((lengths, pairs.T), shape=[len(self.cell)] * 2).tocsr()

    def independent(self, places):
        """Lengths from any of some places to all others."""
        return dijkstra(self.graph, directed=False, indices=places, min_only=True)

    def place(self, points):
        away, places = self.tree.query(points)
        require(np.max(away, initial=0.0) < NEAR_M, f"a place is {np.max(away)} m from the cells of the robot")
        return places


def verify(package, floor):
    ways = Ways(package, floor)
    told = json.loads((package / "truth.json").read_text(encoding="utf-8"))
    check_lengths(ways)
    episodes = read_episodes(package / "episodes.json.gz")
    check_episodes(ways, floor, episodes)
    check_table(package / "tasks.csv", episodes)
    things = check_search(package, ways, told["sought"])
    views = check_coverage(package, ways, floor)
    return f"{len(ways.cell)} cells of a robot, {len(episodes)} episodes, {things} things, {views} views"


def check_lengths(ways):
    starts = np.flatnonzero(ways.from_start == 0)
    require(len(starts) > 0, "no length from the start is 0")
    require(ways.to_goal.shape == (len(ways.goal), len(ways.cell)), "lengths to goals are of another shape")
    fields = [
        (starts, ways.from_start),
        *((goal, lengths) for goal, lengths in zip(ways.goal, ways.to_goal, strict=True)),
    ]
    for places, lengths in fields:
        require(np.isfinite(lengths).all(), "a length is not finite")
        require(np.allclose(lengths[places], 0), "a length does not begin with 0")
        expected = ways.independent(places)
        short = (lengths < expected - 0.01).sum()
        require(short == 0, f"{short} ways are shorter than the shortest over the same cells")
        long = (lengths > LONGER * expected + LONGER_M).mean()
        require(long <= MOST_LONGER, f"{long:.3f} of all ways are much longer than the shortest over the same cells")


def read_episodes(path):
    with gzip.open(path, "rt") as file:
        told = json.load(file)
    require(set(told) == {"episodes"}, f"{path.name} has other keys: {sorted(told)}")
    for episode in told["episodes"]:
        kinds = {key: type(value) for key, value in episode.items()}
        require(kinds == EPISODE, f"an episode has other fields: {kinds}")
        lengths = [len(episode[key]) for key in ("start_position", "start_rotation", "goals", "shortest_paths")]
        require(lengths == [3, 4, 1, 1], f"an episode has fields of other lengths: {lengths}")
        require(set(episode["goals"][0]) == {"position", "radius"}, "a goal has other fields")
        require(all(set(point) == POINT for point in episode["shortest_paths"][0]), "a path has other fields")
        require({"geodesic_distance", "euclidean_distance"} <= set(episode["info"]), "an episode lacks its distance")
    ids = [episode["episode_id"] for episode in told["episodes"]]
    require(len(set(ids)) == len(ids), "an id is there twice")
    return told["episodes"]


def upright(points):
    """From the frame of Habitat to that of the other files."""
    points = np.asarray(points, dtype=float)
    return np.stack([points[..., 0], -points[..., 2], points[..., 1]], axis=-1)


def looks(rotations):
    """Where a body looks that looks along -z when it is not turned, in the frame of the other files."""
    x, y, z, w = np.asarray(rotations, dtype=float).T
    return upright(-np.column_stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)]))


def check_episodes(ways, floor, episodes):
    for episode in episodes:
        name = f"episode {episode['episode_id']}"
        start, goal = upright(episode["start_position"]), upright(episode["goals"][0]["position"])
        points = episode["shortest_paths"][0]
        path = upright([point["position"] for point in points])
        turns = np.array([episode["start_rotation"], *(point["rotation"] for point in points)])
        require(len(path) > 2, f"{name} has a path of {len(path)} points")
        require(np.allclose(np.linalg.norm(turns, axis=1), 1, atol=1e-3), f"{name} has a rotation that is none")
        ends = np.abs([path[0] - start, path[-1] - goal])
        # Wheels rest on a plane, and the floor is as rough as it is.
        require(
            ends[:, :2].max() < 0.05 and ends.max() < NEAR_M, f"{name} has a path that is {ends.max()} m from its ends"
        )
        steps = np.diff(path, axis=0)
        along = (looks(turns[1:])[1:-1] * (path[2:] - path[:-2])).sum(axis=1) / np.maximum(
            np.linalg.norm(path[2:] - path[:-2], axis=1), 1e-6
        )
        require(np.median(along) > 0.9, f"{name} has a robot that does not look along its path")
        told, straight = episode["info"]["geodesic_distance"], np.linalg.norm(goal - start)
        require(abs(episode["info"]["euclidean_distance"] - straight) < 1e-3, f"{name} has another straight line")
        require(told >= straight - 1e-6, f"{name} is shorter than the straight line")
        length = np.linalg.norm(steps, axis=1).sum()
        require(abs(length - told) < 0.02 + 2e-3 * told, f"{name} has a path of {length} m, not {told} m")
        require(ways.tree.query(path)[0].max() < NEAR_M, f"{name} has a path beside the cells of the robot")
        ends = ways.place([start, goal])
        expected = ways.independent([ends[1]])[ends[0]]
        is_alike = expected / OCTILE - 0.2 < told < LONGER * expected + LONGER_M
        require(is_alike, f"{name} is {told} m long, and the shortest way over the same cells {expected} m")
        require(np.min(np.abs(ways.goal - ends[1])) == 0, f"{name} has a goal that is none")


def check_table(path, episodes):
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    require(len(rows) == len(episodes), f"{path.name} has {len(rows)} episodes, not {len(episodes)}")
    for row, episode in zip(rows, episodes, strict=True):
        for end, place in (("start", episode["start_position"]), ("goal", episode["goals"][0]["position"])):
            own = [float(row[f"{end}_{axis}_m"]) for axis in "xyz"]
            require(np.allclose(own, upright(place), atol=1e-3), f"{path.name} has another {end} than the episodes")
        look = looks([episode["start_rotation"]])[0]
        heading = np.radians(float(row["start_heading_deg"]))
        require(np.dot(look[:2], [np.cos(heading), np.sin(heading)]) > 0.999, f"{path.name} has another heading")
        info = episode["info"]
        own = [float(row["geodesic_m"]), float(row["euclidean_m"])]
        expected = [info["geodesic_distance"], info["euclidean_distance"]]
        require(np.allclose(own, expected, atol=1e-3), f"{path.name} has other distances than the episodes")
        require(row["difficulty"] == info["difficulty"], f"{path.name} has another difficulty than the episodes")


def check_search(package, ways, sought):
    with (package / "search.csv").open(encoding="utf-8", newline="") as file:
        rows = {row["id"]: row for row in csv.DictReader(file)}
    path = package / "instances.json"
    all_things = json.loads(path.read_text(encoding="utf-8"))["things"] if path.exists() else []
    things = {thing["id"]: thing for thing in all_things if thing["class"] in sought}
    require(set(rows) == set(things), f"search.csv has other things: {sorted(set(rows) ^ set(things))}")
    for number, row in rows.items():
        at = np.array([float(row[f"{axis}_m"]) for axis in "xyz"])
        require(row["class"] == things[number]["class"], f"search.csv says that {number} is a {row['class']}")
        require(np.allclose(at, things[number]["position"], atol=1e-3), f"search.csv has {number} elsewhere")
        [place] = np.flatnonzero(ways.cell == int(row["cell"]))
        away, _ = ways.tree.query(at)
        own = np.linalg.norm(ways.at[place] - at)
        require(
            abs(own - away) < 2e-3 and abs(float(row["away_m"]) - own) < 2e-3, f"{number} is nearer to another cell"
        )
        told = float(row["from_start_m"])
        require(abs(told - ways.from_start[place]) < 2e-3, f"search.csv has {number} at another length from the start")
    return len(rows)


def check_coverage(package, ways, floor):
    told = json.loads((package / "coverage.json").read_text(encoding="utf-8"))
    require(told["cells"] == len(ways.cell), f"coverage.json is about {told['cells']} cells")
    number = {cell: place for place, cell in enumerate(ways.cell)}
    require(all(view["cell"] in number for view in told["views"]), "a view is not from a cell of the robot")
    places = np.array([number[view["cell"]] for view in told["views"]])
    require(len(set(places)) == len(places), "a view is there twice")
    for view, place in zip(told["views"], places, strict=True):
        require(np.allclose(view["position"], ways.at[place], atol=1e-3), "a view is elsewhere")
        require(abs(view["from_start_m"] - ways.from_start[place]) < 1e-3, "a view is at another length from the start")

    def over(chosen, height):
        up = np.minimum(height, floor.headroom[ways.cell[chosen]] / 2)
        return ways.at[chosen] + np.outer(up, [0, 0, 1])

    random = np.random.default_rng(SEED)
    seen_from = random.choice(len(ways.cell), min(SEEN, len(ways.cell)), replace=False)
    sights, eyes = over(seen_from, told["sight_m"]), over(places, told["height_m"])
    air, is_seen = Air(floor), np.isin(seen_from, places)
    for eye in eyes:
        left = np.flatnonzero(~is_seen & (np.linalg.norm(sights - eye, axis=1) <= told["range_m"] + 1e-6))
        is_seen[left] = air.sees(eye, sights[left])
    unseen = (~is_seen).mean()
    require(unseen <= MOST_UNSEEN, f"{unseen:.3f} of the cells of the robot are seen from no view")
    return len(places)


class Air:
    """The air over each square of the map."""

    def __init__(self, floor):
        self.side_m, self.low = floor.side_m, floor.cell.min(axis=0) - 1
        self.size = floor.cell.max(axis=0) - self.low + 2
        column = (floor.cell - self.low) @ [self.size[1], 1]
        _, first, counts = np.unique(column, return_index=True, return_counts=True)
        level = np.arange(len(column)) - np.repeat(first, counts)
        self.bottom = np.full((np.prod(self.size), counts.max()), np.inf, dtype=np.float32)
        self.top = -self.bottom
        self.bottom[column, level], self.top[column, level] = floor.z, floor.z + floor.headroom

    def sees(self, eye, sights):
        """Which straight lines are in the air."""
        steps = np.ceil(np.linalg.norm(sights[:, :2] - eye[:2], axis=1).max(initial=0.0) / self.side_m * 4) + 1
        is_free = np.ones(len(sights), dtype=bool)
        for share in np.arange(1, steps) / steps:
            points = eye + share * (sights - eye)
            cells = np.clip(np.floor(points[:, :2] / self.side_m).astype(int) - self.low, 0, self.size - 1)
            column = cells @ [self.size[1], 1]
            z = points[:, 2:]
            is_free &= ((self.bottom[column] <= z + 1e-3) & (z - 1e-3 <= self.top[column])).any(axis=1)
        return is_free
