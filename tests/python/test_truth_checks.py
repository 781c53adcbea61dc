"""The checks of ground truth: a good package passes, and each fault is noticed."""

import csv
import gzip
import json
import shutil
import subprocess
import sys
from pathlib import Path

import laspy
import numpy as np
import plyfile
import pytest
import rasterio
from messages import in_messages
from PIL import Image

sys.path.append(str(Path(__file__).parents[1] / "interop/truth"))

import check  # noqa: E402 - the check itself

SMALL = [
    *("--set", "graph.nodes=4", "--set", "texture.size_px=256", "--set", "things.artefacts=4"),
    *("--option", "truth.cell_m=0.1", "--option", "truth.view_range_m=3"),
]
STATES = (0, 255)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The packages `ply` and `truth` of one small cave."""
    folder = tmp_path_factory.mktemp("truth")
    export = ["export", "--target", "ply,truth", "--output", str(folder), "--quiet", *SMALL]
    subprocess.run([sys.executable, "-m", "plume", *export], check=True)
    return folder


def test_a_good_package_passes(folder):
    assert "ground truth" in check.verify(folder / "truth")


def in_arrays(change, name="floor.npz"):
    """A change of the arrays of a file."""

    def edited(package):
        arrays = dict(np.load(package / name))
        change(arrays)
        np.savez(package / name, **arrays)

    return edited


def raise_floor(arrays):
    arrays["z"] += np.float32(0.01)


def lower_ceiling(arrays):
    arrays["headroom"] *= np.float32(0.9)


def forget_cells(arrays):
    for name in set(arrays) - {"cell_m"}:
        arrays[name] = arrays[name][::2]


def tip(arrays):
    arrays["slope"] += np.float32(0.01)


def roughen(arrays):
    arrays["roughness"] += np.float32(0.01)


def step_up(arrays):
    arrays["step"] += np.float32(0.01)


def fence_off(arrays):
    reached = arrays["storey"] >= 0
    arrays["storey"][reached & (arrays["cell"][:, 0] > np.median(arrays["cell"][reached, 0]))] = -1


def join_storeys(arrays):
    arrays["storey"][:] = 0


def in_image(change):
    def edited(package):
        grey = np.asarray(Image.open(package / "map_0.png")).copy()
        Image.fromarray(np.ascontiguousarray(change(grey))).save(package / "map_0.png")

    return edited


def draw_far_off(grey):
    grey[0, 0] = 0
    return grey


def move_origin(package):
    path = package / "map_0.yaml"
    text = path.read_text(encoding="utf-8")
    origin = check.yaml.safe_load(text)["origin"]
    path.write_text(text.replace(str(origin[0]), str(origin[0] + 0.1)), encoding="utf-8")


def free_the_unknown(package):
    path = package / "map_0.yaml"
    path.write_text(path.read_text(encoding="utf-8").replace("0.196", "0.25"), encoding="utf-8")


def tell_another_height(package):
    edit_json(package / "truth.json", lambda told: told["storeys"][0]["floor_m"].__setitem__(0, -99.0))


def edit_json(path, change):
    told = json.loads(path.read_text(encoding="utf-8"))
    change(told)
    path.write_text(json.dumps(told), encoding="utf-8")


def leave_out(package):
    edit_json(package / "truth.json", lambda told: told["files"].pop())


def swap_labels(package):
    def swap(told):
        first, second = told["labels"][:2]
        first["name"], second["name"] = second["name"], first["name"]

    edit_json(package / "labels.json", swap)


def grease(package):
    edit_json(package / "labels.json", lambda told: told["labels"][-1].update(friction=0.01, zone="floor"))


def dig(arrays):
    """An occupied voxel is free."""
    arrays["label"][~np.isin(arrays["label"], STATES)] = 255


def thicken(arrays):
    """Free voxels below others are occupied."""
    label = arrays["label"]
    label[:, :, :, :4][label[:, :, :, :4] == 255] = 2


def fill_the_air(arrays):
    arrays["label"][arrays["label"] == 255] = 0


def relabel(arrays):
    arrays["label"][~np.isin(arrays["label"], STATES)] = 1


def in_both(change):
    """The same change of voxels, and none of the OctoMap to notice it by: that is checked first."""

    def edited(package):
        in_arrays(change, "voxels.npz")(package)
        write_octomap(package)

    return edited


def write_octomap(package):
    """Writes the OctoMap anew from the arrays, by its own library."""
    voxels = check.grids.Blocks(package / "voxels.npz", "label", 0)
    cells, labels = voxels.cells()
    tree = check.grids.octomap.OcTree(voxels.side_m)
    for cell, label in zip(cells[labels != 0], labels[labels != 0], strict=True):
        tree.updateNode(voxels.centres_m(cell), 2.0 if label != 255 else -2.0, True)
    tree.updateInnerOccupancy()
    tree.writeBinary(str(package / "occupancy.bt").encode())


def shift_tree(package):
    path = package / "occupancy.bt"
    path.write_bytes(path.read_bytes().replace(b"res 0.1\n", b"res 0.2\n"))


def flip_a_node(package):
    path = package / "occupancy.bt"
    tree = bytearray(path.read_bytes())
    # The last node has cells as children: one that is free or occupied becomes the other.
    tree[-2:] = bytes(byte ^ 0b11 if byte & 0b11 in (1, 2) else byte for byte in tree[-2:])
    tree[-2:] = bytes(byte ^ 0b11000000 if byte >> 6 in (1, 2) else byte for byte in tree[-2:])
    path.write_bytes(bytes(tree))


def stretch(arrays):
    arrays["distance"] *= np.float32(1.01)


def turn_inside_out(arrays):
    arrays["distance"] *= -1


def reach_further(arrays):
    arrays["distance"][np.isinf(arrays["distance"])] = 0.7


def in_cloud(change):
    """A change of the points of the PLY."""

    def edited(package):
        data = plyfile.PlyData.read(package / "cloud.ply", mmap=False)
        change(data["vertex"].data)
        data.write(package / "cloud.ply")

    return edited


def in_all_clouds(change):
    """A change of the points of all three files."""

    def edited(package):
        in_cloud(change)(package)
        rows = plyfile.PlyData.read(package / "cloud.ply", mmap=False)["vertex"].data
        head, _ = (package / "cloud.pcd").read_bytes().split(b"DATA binary\n")
        (package / "cloud.pcd").write_bytes(head + b"DATA binary\n" + rows.tobytes())
        las = laspy.read(package / "cloud.las")
        las.xyz = np.stack([rows[axis] for axis in "xyz"], axis=1)
        for name, own in [
            ("NormalX", "nx"),
            ("NormalY", "ny"),
            ("NormalZ", "nz"),
            ("label",) * 2,
            ("chunk",) * 2,
            ("thing",) * 2,
        ]:
            las[name] = rows[own]
        las.classification = np.where(rows["label"] == 1, 2, 1)
        las.write(package / "cloud.las")

    return edited


def lift(rows):
    rows["z"] += np.float32(0.01)


def mirror_normals(rows):
    rows["nz"] *= -1


def swap_codes(rows):
    rows["label"] = np.where(rows["label"] == 1, 2, rows["label"])


def next_chunk(rows):
    rows["chunk"] = (rows["chunk"] + 1) % (rows["chunk"].max() + 1)


def next_thing(rows):
    of_thing = rows["thing"] > 0
    rows["thing"][of_thing] = rows["thing"].max() + 1 - rows["thing"][of_thing]


def bunch(rows):
    """Half of the points are where another half is."""
    half = len(rows) // 2
    rows[:half] = rows[half : 2 * half]


def in_las(package):
    las = laspy.read(package / "cloud.las")
    las.classification = np.full(len(las.points), 1, dtype=np.uint8)
    las.write(package / "cloud.las")


def in_raster(change):
    def edited(package):
        path = package / "elevation_0.tif"
        with rasterio.open(path) as raster:
            profile, names, bands = raster.profile, raster.descriptions, raster.read()
        bands = change(bands, profile)
        path.unlink()
        with rasterio.open(path, "w", **profile) as raster:
            raster.write(bands)
            raster.descriptions = names

    return edited


def shift_raster(bands, profile):
    profile["transform"] = profile["transform"] @ rasterio.Affine.translation(1, 0)
    return bands


def swap_bands(bands, _):
    return bands[[1, 0, 2, 3, 4, 5]]


def widen(bands, _):
    bands[:, np.isnan(bands[0])] = 1.0
    return bands


def in_grid_map(change):
    return in_messages("elevation_0.mcap", lambda _, data: change(data))


def shift_grid_map(data):
    """The place of the middle along x follows the head, the header and the sides: 4, 16 and 24 bytes."""
    (x,) = np.frombuffer(data[44:52])
    return data[:44] + np.float64(x + 0.1).tobytes() + data[52:]


def smooth_grid_map(data):
    """Roughness is the last of six layers; behind it are the indices of the start, of four bytes."""
    count = len(data) // 6 // 4 // 2
    numbers = np.frombuffer(data[-4 - 4 * count : -4], dtype=np.float32)
    return data[: -4 - 4 * count] + (numbers / 2).tobytes() + data[-4:]


FAULTS = {
    "a floor too high": (in_arrays(raise_floor), "columns are not what rays meet"),
    "a ceiling too low": (in_arrays(lower_ceiling), "columns are not what rays meet"),
    "every other cell": (in_arrays(forget_cells), "columns are not what rays meet"),
    "another slope": (in_arrays(tip), "the slope at"),
    "another roughness": (in_arrays(roughen), "m rough"),
    "another step": (in_arrays(step_up), "the step at"),
    "a part left out": (in_arrays(fence_off), "can leave a storey"),
    "storeys as one": (in_arrays(join_storeys), "storey 0 is"),
    "an image upside down": (in_image(lambda grey: grey[::-1]), "are free on one side only"),
    "an image in a mirror": (in_image(lambda grey: grey[:, ::-1]), "are free on one side only"),
    "a wall far off": (in_image(draw_far_off), "m from the floor"),
    "no walls": (in_image(lambda grey: np.where(grey == 0, np.uint8(205), grey)), "beside the floor is not occupied"),
    "another origin": (move_origin, "are free on one side only"),
    "a threshold that frees the unknown": (free_the_unknown, "are free on one side only"),
    "another height": (tell_another_height, r"yaml is at "),
    "a file that is not listed": (leave_out, "lists other files"),
    "a raster elsewhere": (in_raster(shift_raster), "another floor"),
    "bands swapped": (in_raster(swap_bands), "another floor"),
    "a raster that is everywhere": (in_raster(widen), "has other cells"),
    "messages elsewhere": (in_grid_map(shift_grid_map), "elevation_0.mcap: another floor"),
    "smooth messages": (in_grid_map(smooth_grid_map), "elevation_0.mcap: another roughness"),
}

FAULTS_OF_GRIDS = {
    "labels swapped": (swap_labels, "labels.json has"),
    "a slippery thing": (grease, "has another friction"),
    "cells of the OctoMap twice as large": (shift_tree, "has cells of"),
    "a cell of the OctoMap in another state": (flip_a_node, "are not those of voxels.npz"),
    "voxels unlike the OctoMap": (in_arrays(dig, "voxels.npz"), "are not those of voxels.npz"),
    "no surface": (in_both(dig), "that are not occupied"),
    "a thick surface": (in_both(thicken), "voxels that are occupied"),
    "no air": (in_both(fill_the_air), "unknown in the air"),
    "another label": (in_both(relabel), "with another label"),
    "distances too long": (in_arrays(stretch, "distance.npz"), "a distance is wrong"),
    "distances inside out": (in_arrays(turn_inside_out, "distance.npz"), "the sign of the other side"),
    "distances beyond the reach": (in_arrays(reach_further, "distance.npz"), "there are distances beyond"),
}

FAULTS_OF_CLOUDS = {
    "points of the PLY off the wall": (in_cloud(lift), "has points elsewhere"),
    "points off the wall": (in_all_clouds(lift), "m from the mesh"),
    "normals upside down": (in_all_clouds(mirror_normals), "other normals"),
    "floor as wall": (in_all_clouds(swap_codes), "other labels"),
    "points in other chunks": (in_all_clouds(next_chunk), "other chunks"),
    "points on other things": (in_all_clouds(next_thing), r"thing \d+ is"),
    "points in bunches": (in_all_clouds(bunch), "points too many or too few"),
    "classes of LAS": (in_las, "has other classes"),
}


def in_text(name, old, new):
    """A text in which the first of something is another."""

    def edited(package):
        text = (package / name).read_text(encoding="utf-8")
        assert old in text
        (package / name).write_text(text.replace(old, new, 1), encoding="utf-8")

    return edited


def in_network(name, value):
    """The first edge has another value."""

    def edited(package):
        path = package / "network.graphml"
        edge, rest = path.read_text(encoding="utf-8").split("<edge", 1)
        before, after = rest.split(f'<data key="{name}">', 1)
        changed = f'{before}<data key="{name}">{value}</data>{after.split("</data>", 1)[1]}'
        path.write_text(f"{edge}<edge{changed}", encoding="utf-8")

    return edited


def forget_a_way(package):
    path = package / "network.graphml"
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    lines.remove(next(line for line in lines if line.startswith("<edge")))
    path.write_text("".join(lines), encoding="utf-8")


def tell_other_sums(package):
    edit_json(package / "truth.json", lambda told: told["network"]["levels"][0].update(length_m=1.0))


def in_leg(change):
    """The first leg of the survey is read in another way."""

    def edited(package):
        path = package / "survey.svx"
        lines = path.read_text(encoding="utf-8").splitlines()
        first = next(number for number, line in enumerate(lines) if line.startswith("*data normal")) + 1
        lines[first] = " ".join(change(lines[first].split()))
        path.write_text("\n".join(lines), encoding="utf-8")

    return edited


def turn_tubes(package):
    """The first room is to the wrong sides, and much wider."""
    path = package / "survey.svx"
    lines = path.read_text(encoding="utf-8").splitlines()
    for number, line in enumerate(lines):
        if lines[number - 1].startswith("*data passage"):
            station, left, right, *others = line.split()
            lines[number] = " ".join([station, f"{float(right) + 2}", f"{float(left) + 2}", *others])
    path.write_text("\n".join(lines), encoding="utf-8")


def forget_rooms(package):
    path = package / "survey.svx"
    text, last = path.read_text(encoding="utf-8").rsplit("*data passage", 1)
    path.write_text(text + last[last.index("*end") :], encoding="utf-8")


FAULTS_OF_TOPOLOGY = {
    "a longer passage": (in_network("length_m", 99.0), "m long"),
    "another slope": (in_network("slope_deg", 45.5), "has a slope of"),
    "another class": (in_network("class", "perhaps"), "is perhaps"),
    "no reason": (in_network("class", "no-go"), "and stopped by None"),
    "a passage one way": (forget_a_way, "has no way back"),
    "other sums": (tell_other_sums, "the passages of level 0 are"),
    "a longer leg": (in_leg(lambda leg: [*leg[:2], str(float(leg[2]) + 1), *leg[3:]]), "m from its place"),
    "magnetic north": (in_leg(lambda leg: [*leg[:3], str((float(leg[3]) + 5) % 360), *leg[4:]]), "m from its place"),
    "a leg down": (in_leg(lambda leg: [*leg[:4], "-45"]), "m from its place"),
    "another station": (in_leg(lambda leg: ["elsewhere", *leg[1:]]), "cavern refuses"),
    "no survey": (in_text("survey.svx", "*data normal", "*data abnormal"), "cavern refuses"),
    "wider rooms": (turn_tubes, "are not what rays meet"),
    "no rooms": (forget_rooms, "has the sections of"),
}


def in_episodes(change):
    def edited(package):
        path = package / "episodes.json.gz"
        with gzip.open(path, "rt") as file:
            told = json.load(file)
        change(told["episodes"][0])
        with gzip.open(path, "wt") as file:
            json.dump(told, file)

    return edited


def in_rows(name, change):
    """Another first row of a table."""

    def edited(package):
        with (package / name).open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        change(rows[0])
        with (package / name).open("w", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, list(rows[0]))
            writer.writeheader()
            writer.writerows(rows)

    return edited


def in_ways(change):
    return in_arrays(change, "geodesic.npz")


def shorten(arrays):
    arrays["from_start"] *= np.float32(0.9)


def lengthen(arrays):
    arrays["to_goal"] *= np.float32(3)


def shift_ways(arrays):
    arrays["position"] += np.float32(0.2)


def swap_goals(arrays):
    arrays["to_goal"] = arrays["to_goal"][::-1]


def keep_z_up(episode):
    x, y, z = episode["start_position"]
    episode["start_position"] = [x, -z, y]


def look_along_x(episode):
    for point in episode["shortest_paths"][0]:
        _, y, _, w = point["rotation"]
        # A quarter turn about y.
        point["rotation"] = [0.0, (y + w) * 0.5**0.5, 0.0, (w - y) * 0.5**0.5]


def cut_corners(episode):
    path = episode["shortest_paths"][0]
    episode["shortest_paths"][0] = [path[0], path[-1]]


def stray(episode):
    path = episode["shortest_paths"][0]
    path[len(path) // 2]["position"][0] += 3.0


def shorten_episode(episode):
    episode["info"]["geodesic_distance"] = episode["info"]["euclidean_distance"] * 0.9


def overlook(package):
    edit_json(package / "coverage.json", lambda told: told["views"].__delitem__(slice(1, None)))


def see_through(package):
    edit_json(package / "coverage.json", lambda told: told["views"][0].update(position=[0.0, 0.0, 0.0]))


FAULTS_OF_TASKS = {
    "ways too short": (in_ways(shorten), "shorter than the shortest"),
    "ways too long": (in_ways(lengthen), "much longer than the shortest"),
    "ways elsewhere": (in_ways(shift_ways), "are not on those of the floor"),
    "goals swapped": (in_ways(swap_goals), "does not begin with 0"),
    "another field": (in_episodes(lambda episode: episode.pop("start_room")), "has other fields"),
    "no distance": (in_episodes(lambda episode: episode["info"].pop("geodesic_distance")), "lacks its distance"),
    "Z up": (in_episodes(keep_z_up), "m from its ends"),
    "another axis ahead": (in_episodes(look_along_x), "does not look along its path"),
    "a path through the rock": (in_episodes(cut_corners), "has a path of 2 points"),
    "a stray path": (in_episodes(stray), "has a path"),
    "shorter than the straight line": (in_episodes(shorten_episode), "shorter than the straight line"),
    "another start in the table": (in_rows("tasks.csv", lambda row: row.update(start_x_m="0")), "another start"),
    "another heading": (in_rows("tasks.csv", lambda row: row.update(start_heading_deg="17")), "another heading"),
    "another distance": (in_rows("tasks.csv", lambda row: row.update(geodesic_m="1")), "other distances"),
    "a thing elsewhere": (in_rows("search.csv", lambda row: row.update(x_m="99")), "elsewhere"),
    "another thing": (in_rows("search.csv", lambda row: row.update(id="0")), "has other things"),
    "a thing nearer to the start": (
        in_rows("search.csv", lambda row: row.update(from_start_m="0.1")),
        "another length",
    ),
    "one view only": (overlook, "are seen from no view"),
    "a view elsewhere": (see_through, "a view is elsewhere"),
}


@pytest.fixture(scope="module")
def mesh(world):
    return check.trimesh.Trimesh(world.vertices, world.faces, process=False)


@pytest.fixture(scope="module")
def world(folder):
    return check.World(folder / "ply")


def noticed(fault, faults, folder, tmp_path, verify):
    change, message = faults[fault]
    shutil.copytree(folder / "truth", tmp_path / "truth")
    change(tmp_path / "truth")
    with pytest.raises(check.Failure, match=message):
        verify(tmp_path / "truth")


@pytest.mark.parametrize("fault", FAULTS)
def test_a_faulty_package_fails(fault, folder, tmp_path):
    shutil.copytree(folder / "ply", tmp_path / "ply")
    noticed(fault, FAULTS, folder, tmp_path, check.verify)


@pytest.mark.parametrize("fault", FAULTS_OF_GRIDS)
def test_faulty_grids_fail(fault, folder, world, tmp_path):
    noticed(fault, FAULTS_OF_GRIDS, folder, tmp_path, lambda package: check.grids.verify(package, world, 0.5))


@pytest.mark.parametrize("fault", FAULTS_OF_CLOUDS)
def test_faulty_clouds_fail(fault, folder, world, tmp_path):
    noticed(fault, FAULTS_OF_CLOUDS, folder, tmp_path, lambda package: check.clouds.verify(package, world))


@pytest.mark.parametrize("fault", FAULTS_OF_TOPOLOGY)
def test_faulty_networks_fail(fault, folder, mesh, tmp_path):
    noticed(fault, FAULTS_OF_TOPOLOGY, folder, tmp_path, lambda package: check.topology.verify(package, mesh))


@pytest.mark.parametrize("fault", FAULTS_OF_TASKS)
def test_faulty_tasks_fail(fault, folder, tmp_path):
    floor = check.Floor(folder / "truth")
    noticed(fault, FAULTS_OF_TASKS, folder, tmp_path, lambda package: check.tasks.verify(package, floor))


def test_a_survey_with_errors_passes(folder, mesh, tmp_path):
    errors = ["--option", "truth.tape_sd_m=0.05", "--option", "truth.angle_sd_deg=1"]
    files = ["--option", 'truth.files=["floor", "network", "survey"]']
    export = ["export", "--target", "truth", "--output", str(tmp_path / "truth"), "--quiet", *SMALL, *errors, *files]
    subprocess.run([sys.executable, "-m", "plume", *export], check=True)
    assert "stations" in check.topology.verify(tmp_path / "truth", mesh)
