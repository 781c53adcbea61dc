"""Holds a package of target `truth` to the triangles of target `ply` beside it, read by plyfile and met by rays of Embree.

    check.py PACKAGE_DIR

Floor, maps and rasters:

- Rays straight up and down through the centres of cells, some thousands, meet the floor and what is over it where `floor.npz`
  says, and nowhere else is there air that it does not list.
- Slope, roughness and step are those of a plane fitted by NumPy.
- A storey is connected, and no cell of it is over another; beyond its border there is nothing onto which the robot could drive.
- Each raster, read by rasterio, has the numbers of its storey at their places, and no others; so have the messages of grid_map, decoded
  by their own definition, where rows go down from the largest x and columns from the largest y.
- Each map, read by the formula of the map server of Nav2, is free exactly where its storey is, and occupied only beside that.

`grids.py` checks voxels and distances, `clouds.py` points, `topology.py` the network and its survey, `tasks.py` lengths of ways and
what there is to do.
"""

import json
import sys
from pathlib import Path

import clouds
import grids
import numpy as np
import rasterio
import tasks
import topology
import trimesh
import yaml
from failure import Failure, require
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from PIL import Image
from scipy.ndimage import binary_dilation
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree
from world import World

COLUMNS = 4000
SEED = 1
# Embree counts in single precision, and may miss an edge between two triangles.
WITHIN_M = 0.002
MOST_MISSED = 0.005
LEAST_HEIGHT_M = 0.05
RELIEF_M = 0.25
RELIEFS = 300
SEEN_M = 0.3
# What single and double precision may see differently.
ROUNDING_M = 1e-5
# Bands of a raster.
BANDS = ("floor", "ceiling", "headroom", "slope", "step", "roughness")
LAYERS = ["elevation", *BANDS[1:]]


class Floor:
    """The cells of `floor.npz`."""

    def __init__(self, package):
        arrays = np.load(package / "floor.npz")
        self.side_m = float(arrays["cell_m"])
        self.cell, self.z, self.headroom = arrays["cell"], arrays["z"], arrays["headroom"]
        self.slope, self.step, self.roughness = arrays["slope"], arrays["step"], arrays["roughness"]
        self.storey = arrays["storey"]
        require(len(self.z) > 0, "there is no floor")
        self.centre_m = (self.cell + 0.5) * self.side_m
        self.index = {}
        for number, cell in enumerate(map(tuple, self.cell)):
            self.index.setdefault(cell, []).append(number)

    def nearest(self, cell, z):
        return min(self.index.get(tuple(cell), []), key=lambda number: abs(self.z[number] - z), default=None)


def verify(package):
    floor, world = Floor(package), World(package.with_name("ply"))
    told = json.loads((package / "truth.json").read_text(encoding="utf-8"))
    check_table(package, told["files"])
    mesh = trimesh.Trimesh(world.vertices, world.faces, process=False)
    missed = check_columns(floor, mesh)
    check_reliefs(floor)
    check_reach(floor, told["robot"])
    for storey in told["storeys"]:
        check_map(floor, package / storey["map"], storey)
        check_raster(floor, package / storey["elevation"], storey)
        check_grid_map(floor, package / storey["grid_map"], storey)
    found = [grids.verify(package, world, told["reach_m"]), clouds.verify(package, world)]
    found += [topology.verify(package, mesh), tasks.verify(package, floor)]
    free = np.isin(floor.storey, [storey["storey"] for storey in told["storeys"]]).sum() * floor.side_m**2
    return (
        f"ground truth: {len(floor.z)} cells, {missed} of {COLUMNS} columns unlike the rays; "
        f"{len(told['storeys'])} maps of {free:.0f} m²; {'; '.join(found)}"
    )


def check_table(package, files):
    """`truth.json` lists every file of ground truth, with its unit and frame."""
    others = {"manifest.json", "instances.json", "stations.csv", "truth.json", "README.md", "LICENSE.md"}
    listed = {entry["file"] for entry in files} | {path.name for path in package.glob("*.yaml")}
    there = {path.name for path in package.iterdir()} - others
    require(listed == there, f"truth.json lists other files than there are: {sorted(listed ^ there)}")
    for entry in files:
        require(
            all(entry[key] for key in ("content", "unit", "frame")), f"truth.json says too little of {entry['file']}"
        )


def check_columns(floor, mesh):
    """Number of columns in which the rays see something else."""
    random = np.random.default_rng(SEED)
    low, high = floor.cell.min(axis=0), floor.cell.max(axis=0)
    of_floor = floor.cell[random.integers(len(floor.cell), size=COLUMNS // 2)]
    anywhere = random.integers(low, high + 1, size=(COLUMNS - len(of_floor), 2))
    cells = np.concatenate([of_floor, anywhere])
    below = mesh.bounds[0][2] - 1
    origins = np.column_stack([(cells + 0.5) * floor.side_m, np.full(len(cells), below)])
    points, rays, triangles = mesh.ray.intersects_location(origins, np.tile([0.0, 0.0, 1.0], (len(origins), 1)))
    heights, ups = points[:, 2], mesh.face_normals[triangles, 2]
    seen = [[] for _ in cells]
    for ray, height, up in sorted(zip(rays, heights, ups, strict=True)):
        seen[ray].append((height, up))
    missed = sum(not alike(air(crossings), listed(floor, cell)) for cell, crossings in zip(cells, seen, strict=True))
    require(missed <= MOST_MISSED * COLUMNS, f"{missed} of {COLUMNS} columns are not what rays meet")
    return missed


def air(crossings):
    """Floor and ceiling of the air along a ray that begins in the rock."""
    solids, floor, found = 1, None, []
    for height, up in crossings:
        if up > 0:
            solids -= 1
            if solids == 0:
                floor = height
        else:
            if solids == 0 and floor is not None:
                found.append((floor, height))
            solids += 1
    return [(low, high) for low, high in found if high - low >= LEAST_HEIGHT_M]


def listed(floor, cell):
    return [(floor.z[number], floor.z[number] + floor.headroom[number]) for number in floor.index.get(tuple(cell), [])]


def alike(one, other):
    # What is just high enough for one may not be for the other.
    tall = [[gap for gap in gaps if gap[1] - gap[0] > LEAST_HEIGHT_M + WITHIN_M] for gaps in (one, other)]
    return len(tall[0]) == len(tall[1]) and np.allclose(*tall, rtol=0, atol=WITHIN_M)


def check_reliefs(floor):
    numbers = np.random.default_rng(SEED).integers(len(floor.z), size=RELIEFS)
    reach = int(RELIEF_M / floor.side_m)
    offsets = [(i, j) for j in range(-reach, reach + 1) for i in range(-reach, reach + 1)]
    for number in numbers:
        cell, z = floor.cell[number], floor.z[number]
        points, steps = [], [0.0]
        for offset in offsets:
            away = np.hypot(*offset) * floor.side_m
            other = floor.nearest(cell + offset, z)
            if other is None:
                continue
            rise = float(floor.z[other]) - float(z)
            if away <= RELIEF_M and abs(rise) <= 1.5 * away:
                points.append((*(np.array(offset) * floor.side_m), rise))
            if max(map(abs, offset)) == 1:
                steps.append(abs(rise))
        require(abs(max(steps) - floor.step[number]) < 1e-4, f"the step at {floor.centre_m[number]} is {max(steps)} m")
        if not np.isfinite(floor.slope[number]):
            continue
        x, y, rise = np.array(points).T
        plane, *_ = np.linalg.lstsq(np.column_stack([x, y, np.ones(len(x))]), rise, rcond=None)
        slope = np.arctan(np.hypot(*plane[:2]))
        rough = np.abs(plane[0] * x + plane[1] * y + plane[2] - rise).max()
        require(abs(slope - floor.slope[number]) < 1e-3, f"the slope at {floor.centre_m[number]} is {slope} rad")
        require(
            abs(rough - floor.roughness[number]) < 1e-3, f"the floor at {floor.centre_m[number]} is {rough} m rough"
        )


def check_reach(floor, robot):
    """Storeys are the whole of what is connected for this robot, each connected in itself and nowhere over itself."""
    reached = floor.storey >= 0
    start, end = links(floor, robot, -ROUNDING_M)
    leaving = reached[start] & ~reached[end]
    require(not leaving.any(), f"the robot can leave a storey in {leaving.sum()} places that are in none")
    start, end = links(floor, robot, ROUNDING_M)
    for storey in np.unique(floor.storey[reached]):
        own = floor.storey == storey
        cells = floor.cell[own]
        require(len(np.unique(cells, axis=0)) == len(cells), f"storey {storey} is over itself")
        inside = own[start] & own[end]
        number = np.cumsum(own) - 1
        ends = (number[start[inside]], number[end[inside]])
        parts, _ = connected_components(
            coo_matrix((np.ones(inside.sum()), ends), shape=[len(cells)] * 2), directed=False
        )
        require(parts == 1, f"storey {storey} is in {parts} parts")


def links(floor, robot, slack_m):
    """From and to where the robot can drive in one step, if it gets over and under this much more."""
    low = floor.cell.min(axis=0) - 1
    rows, columns = floor.cell.max(axis=0) - low + 2
    column = (floor.cell - low) @ [columns, 1]
    _, first, counts = np.unique(column, return_index=True, return_counts=True)
    numbers = np.arange(len(column))
    over = np.full((rows * columns, counts.max()), -1)
    over[column, numbers - np.repeat(first, counts)] = numbers
    ceiling = floor.z + floor.headroom
    # Where there is no slope the robot cannot be.
    carries = floor.slope <= np.radians(robot["slope_deg"]) + slack_m
    found = []
    for towards in [(1, 0), (0, 1), (1, 1), (-1, 1), (-1, 0), (0, -1), (-1, -1), (1, -1)]:
        run_m = np.hypot(*towards) * floor.side_m
        most_m = max(robot["step_m"], np.tan(np.radians(robot["slope_deg"])) * run_m)
        others = over[column + np.dot(towards, [columns, 1])]
        rises = np.abs(floor.z[others] - floor.z[:, None])
        heights = np.minimum(ceiling[others], ceiling[:, None]) - np.maximum(floor.z[others], floor.z[:, None])
        may = (others >= 0) & carries[others] & (rises <= most_m + slack_m) & (heights >= robot["height_m"] - slack_m)
        nearest = np.where(may, rises, np.inf).argmin(axis=1)
        can = may.any(axis=1)
        found.append(np.stack([numbers[can], others[numbers, nearest][can]]))
    return np.concatenate(found, axis=1)


def check_map(floor, path, storey):
    about = yaml.safe_load(path.read_text(encoding="utf-8"))
    grey = np.asarray(Image.open(path.with_name(about["image"])).convert("L"), dtype=float)
    # As the map server of Nav2 does in mode `trinary`.
    require(about["mode"] == "trinary" and about["negate"] == 0, f"{path.name} is of another mode")
    occupancy = (255 - grey) / 255
    occupied, free = occupancy > about["occupied_thresh"], occupancy < about["free_thresh"]
    centres = [places(about, state) for state in (free, occupied)]
    own = floor.storey == storey["storey"]
    expected = {tuple(cell) for cell in floor.cell[own]}
    drawn = {tuple(cell) for cell in np.floor(centres[0] / floor.side_m).astype(int)}
    require(drawn == expected, f"{path.name}: {len(drawn ^ expected)} cells are free on one side only")
    beside = binary_dilation(free, np.ones((3, 3))) & ~free
    require(occupied[beside].all(), f"{path.name}: something beside the floor is not occupied")
    away, _ = cKDTree(centres[0]).query(centres[1])
    require(
        np.max(away, initial=0.0) <= SEEN_M + 1e-6,
        f"{path.name}: something is occupied {np.max(away)} m from the floor",
    )
    low, high = floor.z[own].min(), floor.z[own].max()
    require(np.allclose(storey["floor_m"], [low, high], atol=1e-5), f"{path.name} is at {low} to {high} m")


def check_raster(floor, path, storey):
    """Each band at the place of each cell, found by the transform of the file."""
    with rasterio.open(path) as raster:
        require(raster.descriptions == BANDS, f"{path.name} has the bands {raster.descriptions}")
        transform, bands = raster.transform, raster.read()

    def at(centres_m):
        rows, columns = rasterio.transform.rowcol(transform, *centres_m.T)
        return bands[:, rows, columns]

    check_values(floor, path, storey, np.isfinite(bands[0]).sum(), at)


def check_grid_map(floor, path, storey):
    """Each layer at the place of each cell, found by the geometry of the messages."""
    with path.open("rb") as file:
        maps = [map_ for *_, map_ in make_reader(file, decoder_factories=[DecoderFactory()]).iter_decoded_messages()]
    require(len(maps) > 0, f"{path.name} has no message")
    layers = [layers_of(map_, path) for map_ in maps]

    def at(centres_m):
        found = np.full((len(LAYERS), len(centres_m)), np.nan)
        for map_, values in zip(maps, layers, strict=True):
            middle = np.array([map_.info.pose.position.x, map_.info.pose.position.y])
            corner = middle + np.array([map_.info.length_x, map_.info.length_y]) / 2
            rows, columns = np.floor((corner - centres_m) / map_.info.resolution).astype(int).T
            here = (rows >= 0) & (rows < values.shape[1]) & (columns >= 0) & (columns < values.shape[2])
            found[:, here] = values[:, rows[here], columns[here]]
        return found

    check_values(floor, path, storey, sum(np.isfinite(values[0]).sum() for values in layers), at)


def layers_of(map_, path):
    """The numbers of a message by layer, row and column."""
    require((map_.layers, map_.basic_layers) == (LAYERS, LAYERS[:1]), f"{path.name} has the layers {map_.layers}")
    require((map_.outer_start_index, map_.inner_start_index) == (0, 0), f"{path.name} does not begin at its start")
    sides = [map_.info.length_x, map_.info.length_y]
    rows, columns = np.round(np.array(sides) / map_.info.resolution).astype(int)
    expected = [("column_index", columns, rows * columns), ("row_index", rows, rows)]
    for array in map_.data:
        found = [(one.label, one.size, one.stride) for one in array.layout.dim]
        require(found == expected and array.layout.data_offset == 0, f"{path.name} has the dimensions {found}")
    return np.array([np.reshape(array.data, (columns, rows)).T for array in map_.data])


def check_values(floor, path, storey, count, at):
    """As many numbers as the storey has cells, and at each what the floor says."""
    own = floor.storey == storey["storey"]
    require(count == own.sum(), f"{path.name} has other cells than {own.sum()}")
    expected = (floor.z, floor.z + floor.headroom, floor.headroom, floor.slope, floor.step, floor.roughness)
    for name, found, values in zip(BANDS, at(floor.centre_m[own]), expected, strict=True):
        require(np.allclose(found, values[own], rtol=0, atol=1e-6, equal_nan=True), f"{path.name}: another {name}")


def places(about, state):
    """Centres of the pixels in a state, in metres; the origin is the lower left corner of the image."""
    rows, columns = np.nonzero(state)
    from_below = state.shape[0] - 1 - rows
    return np.array(about["origin"][:2]) + (np.column_stack([columns, from_below]) + 0.5) * about["resolution"]


def main():
    try:
        print(verify(Path(sys.argv[1])))
    except Failure as failure:
        sys.exit(str(failure))


if __name__ == "__main__":
    main()
