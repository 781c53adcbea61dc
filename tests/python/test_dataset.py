"""Datasets as the command of the package makes them, with packages that need its USD library."""

import csv
import json
import subprocess
import sys

from pxr import Usd

SPEC = """
name = "pair"
seeds = [1, 2]
targets = ["isaac"]
sheet = 0
set = ["graph.nodes=3", "texture.size_px=256", "mesh.voxel_m=0.5", "things.cover=0"]
"""


def test_workers_have_the_usd_library_of_this_interpreter(tmp_path):
    (tmp_path / "pair.toml").write_text(SPEC, encoding="utf-8")
    command = [sys.executable, "-m", "plume", "dataset", "pair.toml", "-o", "pair", "--quiet"]
    subprocess.run(command, cwd=tmp_path, check=True)
    rows = json.loads((tmp_path / "pair/index.json").read_text(encoding="utf-8"))
    assert [row["seed"] for row in rows] == [1, 2]
    for row in rows:
        stage = Usd.Stage.Open(str(tmp_path / "pair" / row["path"] / "isaac/pair.usda"))
        assert stage.GetDefaultPrim().IsValid()


def test_the_index_is_the_same_as_a_table(tmp_path):
    spec = SPEC.replace('"isaac"', '"obj"')
    (tmp_path / "pair.toml").write_text(spec, encoding="utf-8")
    subprocess.run([sys.executable, "-m", "plume", "dataset", "pair.toml", "--quiet"], cwd=tmp_path, check=True)
    rows = json.loads((tmp_path / "pair/index.json").read_text(encoding="utf-8"))
    with (tmp_path / "pair/index.csv").open(encoding="utf-8", newline="") as table:
        found = list(csv.DictReader(table))
    assert [list(row) for row in found] == [list(row) for row in rows]
    for row, line in zip(rows, found, strict=True):
        assert {key: "" if value is None else str(value) for key, value in row.items()} == line


def test_where_no_cave_is_left_out_there_is_still_a_table_of_them(tmp_path):
    (tmp_path / "pair.toml").write_text(SPEC.replace('"isaac"', ""), encoding="utf-8")
    subprocess.run([sys.executable, "-m", "plume", "dataset", "pair.toml", "--quiet"], cwd=tmp_path, check=True)
    assert (tmp_path / "pair/failed.csv").read_text(encoding="utf-8") == "item,seed,fault\n"
