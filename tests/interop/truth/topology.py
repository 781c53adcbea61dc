"""The network of passages, read by networkx, and the survey, read by `cavern` of Survex.

- Each passage is there both ways: lengths and slopes are those of its stations, and the sums for levels those of `truth.json`.
- What is not `go` says why, beyond its limit, and `go` does not; there is no class but the three.
- `cavern` places every station of the survey where the network has it, within what its file is rounded to, or what the stated
  errors allow, and no other, and knows a section at both ends of each passage.
- Up, down, left and right of these are what rays of Embree meet.
"""

import json
import math
import re
import subprocess
import tempfile
from pathlib import Path

import networkx
import numpy as np
from failure import require

CLASSES = {"go", "marginal", "no-go"}
# `cavern` writes whole centimetres.
PLACED_M = 0.011
# The floor is known at the centres of cells, and walls to a cell.
MOST_ODD = 0.1
FURTHEST_M = 30.0


def verify(package, mesh):
    told = json.loads((package / "truth.json").read_text(encoding="utf-8"))
    graph = networkx.read_graphml(package / "network.graphml")
    require(graph.is_directed(), "the network has no directions")
    places = {name: np.array([node[axis] for axis in "xyz"]) for name, node in graph.nodes(data=True)}
    check_passages(graph, places)
    check_sums(graph, told["network"])
    legs = check_survey(package / "survey.svx", graph, places, told["network"], mesh)
    return f"{len(places)} stations, {legs} legs"


def check_passages(graph, places):
    for start, end, edge in graph.edges(data=True):
        name = f"the passage {start}..{end}"
        require(graph.has_edge(end, start), f"{name} has no way back")
        x, y, z = places[end] - places[start]
        require(abs(edge["length_m"] - math.hypot(x, y, z)) < 2e-3, f"{name} is {edge['length_m']} m long")
        slope = math.degrees(math.atan2(z, math.hypot(x, y)))
        require(
            abs(edge["slope_deg"] - slope) < 2e-3, f"{name} has a slope of {edge['slope_deg']}, not {slope} degrees"
        )
        require(edge["class"] in CLASSES, f"{name} is {edge['class']}")
        is_go = edge["class"] == "go"
        require(
            is_go == ("stopped_by" not in edge), f"{name} is {edge['class']} and stopped by {edge.get('stopped_by')}"
        )
        if not is_go and edge["stopped_by"] != "no-floor":
            more = edge["value"] - edge["limit"]
            is_beyond = more <= 0 if edge["stopped_by"] in ("headroom", "width") else more >= 0
            require(is_beyond, f"{name} is stopped by what is within its limit")


def check_sums(graph, told):
    level = networkx.get_node_attributes(graph, "level")
    found = {}
    for start, end, edge in graph.edges(data=True):
        key = level[start] if level[start] == level[end] else None
        found[key] = found.get(key, 0) + edge["length_m"] / 2
    expected = {entry["level"]: entry["length_m"] for entry in told["levels"]} | {None: told["between_levels_m"]}
    for key in found | expected:
        own, other = found.get(key, 0), expected.get(key, 0)
        require(abs(own - other) < 0.01 + 1e-3 * own, f"the passages of level {key} are {own} m long, not {other} m")
    counted = (graph.number_of_nodes(), graph.number_of_edges() / 2, sum(found.values()))
    said = (told["stations"], told["passages"], told["length_m"])
    require(np.allclose(counted, said, rtol=1e-3, atol=0.01), f"truth.json counts {said}, the network {counted}")


def check_survey(path, graph, places, told, mesh):
    """Number of legs."""
    lines = dumped(path)
    placed = {name.split(".")[-1]: place for name, place in nodes(lines)}
    require(set(placed) == set(places), f"the survey has other stations: {sorted(set(placed) ^ set(places))}")
    legs = sum(line.startswith("LEG ") for line in lines)
    require(legs == graph.number_of_edges() / 2, f"the survey has {legs} legs")
    sd_m = told["tape_sd_m"] + math.radians(told["angle_sd_deg"]) * told["length_m"]
    worst = max((np.abs(placed[name] - places[name]).max() for name in places), default=0.0)
    require(worst < PLACED_M + 5 * sd_m, f"the survey has a station {worst} m from its place")
    require(sd_m == 0 or legs == 0 or worst > 0, "the survey has no errors")
    check_sections(lines, path, places, mesh)
    return legs


def dumped(path):
    """What `cavern` makes of a survey."""
    with tempfile.TemporaryDirectory() as folder:
        cave = Path(folder) / "survey.3d"
        done = subprocess.run(
            ["cavern", "-q", "-o", cave, path.resolve()], cwd=folder, capture_output=True, text=True, check=False
        )
        require(done.returncode == 0, f"cavern refuses the survey: {done.stdout[-500:]}{done.stderr[-500:]}")
        require("warning" not in done.stdout.lower(), f"cavern warns of the survey: {done.stdout[-500:]}")
        dump = subprocess.run(["dump3d", "--legs", cave], capture_output=True, check=True).stdout
    return dump.decode("latin-1").splitlines()


def nodes(lines):
    for line in lines:
        match = re.match(r"NODE (\S+) (\S+) (\S+) \[([^]]*)\]", line)
        if match:
            yield match[4], np.array([float(match[axis]) for axis in (1, 2, 3)])


def check_sections(lines, path, places, mesh):
    rows = [match for line in lines if (match := re.match(r"XSECT (\S+) (\S+) (\S+) (\S+) \[([^]]*)\]", line))]
    pairs = list(zip(rows[::2], rows[1::2], strict=True))
    legs = sum(line.startswith("LEG ") for line in lines)
    require(len(pairs) == legs, f"the survey has the sections of {len(pairs)} of {legs} passages")
    origins, ways, told = [], [], []
    for pair in pairs:
        names = [row[5].split(".")[-1] for row in pair]
        x, y, _ = places[names[1]] - places[names[0]]
        left = np.array([-y, x, 0.0]) / max(math.hypot(x, y), 1e-9)
        for name, row in zip(names, pair, strict=True):
            for way, value in zip((left, -left, [0, 0, 1], [0, 0, -1]), row.groups(), strict=False):
                origins.append(places[name])
                ways.append(way)
                told.append(float(value))
    if not told:
        return
    told = np.array(told)
    points, rays, _ = mesh.ray.intersects_location(np.array(origins), np.array(ways, dtype=float), multiple_hits=False)
    met = np.full(len(told), np.inf)
    met[rays] = np.linalg.norm(points - np.array(origins)[rays], axis=1)
    is_odd = np.abs(np.minimum(met, FURTHEST_M) - told) > 0.1 + 0.05 * told
    require(is_odd.mean() <= MOST_ODD, f"{is_odd.sum()} of {len(told)} rooms around stations are not what rays meet")
