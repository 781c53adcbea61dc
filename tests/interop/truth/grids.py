"""Voxels and distances, held to the triangles by libigl, and the OctoMap, read by its own library.

- The OctoMap has the state of every cell of `voxels.npz`, and knows nothing elsewhere.
- In some columns of cells, every cell of which the centre is so near the surface that this must pass through is occupied, every
  one that is too far is not, and what is not occupied is free in the air and unknown elsewhere.
- The surface passes through occupied cells wherever it is sampled, and their labels are at least those of the triangles there.
- Distances from the centres in these columns are those of libigl, and their signs tell air from rock.
"""

import json

import numpy as np
import octomap
from failure import require

SEED = 1
COLUMNS = 400
SAMPLES = 100_000
WITHIN_M = 1e-4
# How near the surface libigl may be of another opinion about air.
ON_SURFACE_M = 1e-3
UNKNOWN, FREE = 0, 255


class Blocks:
    """A sparse grid of blocks of 8 × 8 × 8 cells."""

    def __init__(self, path, name, empty):
        arrays = np.load(path)
        self.side_m, self.block, self.values, self.empty = float(arrays["cell_m"]), arrays["block"], arrays[name], empty
        self.index = {place: number for number, place in enumerate(map(tuple, self.block))}
        require(len(self.index) == len(self.block) > 0, f"{path.name} has no block, or one twice")

    def cells(self):
        """All cells of all blocks, and their values."""
        within = np.stack(np.unravel_index(np.arange(512), (8, 8, 8)), axis=1)
        return (8 * self.block[:, None] + within).reshape(-1, 3), self.values.reshape(-1)

    def at(self, cells):
        numbers = np.array([self.index.get(place, -1) for place in map(tuple, cells // 8)])
        return np.where(numbers < 0, self.empty, self.values[(numbers, *(cells % 8).T)])

    def centres_m(self, cells):
        return (cells + 0.5) * self.side_m


def verify(package, world, reach_m):
    voxels = Blocks(package / "voxels.npz", "label", UNKNOWN)
    distances = Blocks(package / "distance.npz", "distance", np.inf)
    check_labels(package, world)
    leaves = check_octomap(package / "occupancy.bt", voxels)
    cells = columns(voxels)
    centres = voxels.centres_m(cells)
    away, _, _ = world.nearest(centres)
    is_air = world.is_air(centres)
    check_states(voxels, cells, away, is_air)
    check_samples(voxels, world)
    worst = check_distances(distances, cells, away, is_air, reach_m)
    return f"{leaves} leaves of an OctoMap, {len(cells)} voxels; distances within {worst:.0e} m"


def check_labels(package, world):
    told = json.loads((package / "labels.json").read_text(encoding="utf-8"))
    require((told["unknown"], told["free"]) == (UNKNOWN, FREE), "labels.json has other states")
    names = {entry["label"]: entry["name"] for entry in told["labels"]}
    require(names == world.names, f"labels.json has {names}, the PLY {world.names}")
    zones = {entry["name"]: entry["friction"] for entry in told["labels"][:3]}
    for entry in told["labels"]:
        is_alike = entry["friction"] == zones.get(entry["zone"])
        require(is_alike, f"{entry['name']} has another friction than its zone {entry['zone']}")
    require(all(friction > 0 for friction in zones.values()), f"labels.json has the frictions {zones}")


def check_octomap(path, voxels):
    tree = octomap.OcTree(str(path).encode())
    require(abs(tree.getResolution() - voxels.side_m) < 1e-9, f"the OctoMap has cells of {tree.getResolution()} m")
    require(tree.size() == tree.calcNumNodes() > 1, f"the OctoMap has {tree.calcNumNodes()} nodes, not {tree.size()}")
    cells, labels = voxels.cells()
    around = np.random.default_rng(SEED).integers(cells.min(axis=0) - 20, cells.max(axis=0) + 21, size=(20_000, 3))
    cells, labels = np.concatenate([cells, around]), np.concatenate([labels, voxels.at(around)])
    # The library says -1 for unknown, 0 for free and 1 for occupied.
    expected = np.select([labels == UNKNOWN, labels == FREE], [-1, 0], 1)
    found = tree.getLabels(voxels.centres_m(cells).astype(np.float64))
    wrong = int((found != expected).sum())
    require(wrong == 0, f"{wrong} of {len(cells)} cells of the OctoMap are not those of voxels.npz")
    return tree.getNumLeafNodes()


def columns(voxels):
    """All cells of some columns of blocks, a cell wide, and those below and above."""
    random = np.random.default_rng(SEED)
    blocks = voxels.block[random.choice(len(voxels.block), COLUMNS)]
    corners = 8 * blocks + np.append(random.integers(8, size=2), -8)
    return (corners[:, None] + np.arange(24)[:, None] * [0, 0, 1]).reshape(-1, 3)


def check_states(voxels, cells, away, is_air):
    found, side = voxels.at(cells), voxels.side_m
    occupied = (found != UNKNOWN) & (found != FREE)
    empty = int((~occupied & (away < side / 2 - WITHIN_M)).sum())
    require(empty == 0, f"the surface passes through {empty} of {len(cells)} voxels that are not occupied")
    full = int((occupied & (away > side * np.sqrt(3) / 2 + WITHIN_M)).sum())
    require(full == 0, f"the surface is not in {full} of {len(cells)} voxels that are occupied")
    wrong = int((~occupied & ((found == FREE) != is_air) & (away > ON_SURFACE_M)).sum())
    require(wrong == 0, f"{wrong} of {len(cells)} voxels are free in the rock, or unknown in the air")


def check_samples(voxels, world):
    random = np.random.default_rng(SEED)
    faces = random.choice(len(world.faces), SAMPLES, p=world.areas / world.areas.sum())
    weights = random.dirichlet([1, 1, 1], SAMPLES)
    points = np.einsum("nc,nca->na", weights, world.vertices[world.faces[faces]])
    cells = np.floor(points / voxels.side_m).astype(int)
    # A point on the border of a cell may be rounded into the next one, which then is occupied as well.
    found, labels = voxels.at(cells), world.labels[faces]
    wrong = int(((found == UNKNOWN) | (found == FREE) | (found < labels)).sum())
    require(wrong == 0, f"{wrong} of {SAMPLES} points on the surface are in voxels with another label")


def check_distances(distances, cells, away, is_air, reach_m):
    found = distances.at(cells)
    near, far = away < reach_m - WITHIN_M, away > reach_m + WITHIN_M
    worst = np.abs(np.abs(found[near]) - away[near]).max()
    require(worst < WITHIN_M, f"a distance is wrong by {worst} m")
    require(np.isinf(found[far]).all(), f"there are distances beyond {reach_m} m")
    wrong = int((((found < 0) != is_air) & (away > ON_SURFACE_M)).sum())
    require(wrong == 0, f"{wrong} of {len(cells)} distances have the sign of the other side")
    return worst
