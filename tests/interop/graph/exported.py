"""Opens exported graphs with networkx, igraph, karstnet and Graphviz: `exported.py PLUME_PROGRAM RECIPE...`

The graph of each recipe is written in every format there is. Each reader must see the same places and passages as the JSON,
to 1 mm, and types that are numbers. At the end one passage is taken away from what they should see, and all must differ.
"""

import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import igraph
import karstnet
import networkx


def millimetres(place):
    return tuple(round(1000 * float(x)) for x in place)


def shape(places, passages):
    """Positions in whole millimetres, and the passages between them."""
    places = {name: millimetres(place) for name, place in places.items()}
    return set(places.values()), {frozenset((places[a], places[b])) for a, b in passages}


def truth(folder):
    nodes = json.loads((folder / "cave.json").read_text())["nodes"]
    places = {node["id"]: [node["coordinates"][axis] for axis in "xyz"] for node in nodes}
    return shape(places, [(node["id"], other) for node in nodes for other in node["edges"]])


def read_networkx(folder):
    graph = networkx.read_graphml(folder / "cave.graphml")
    for _, data in graph.nodes(data=True):
        assert all(isinstance(data[key], float) for key in ("x", "y", "z", "radius")), data
        assert isinstance(data["level"], int) and isinstance(data["active"], bool), data
    return shape({name: [data[axis] for axis in "xyz"] for name, data in graph.nodes(data=True)}, graph.edges)


def read_igraph(folder):
    graph = igraph.Graph.Read_GraphML(str(folder / "cave.graphml"))
    places = {node.index: [node[axis] for axis in "xyz"] for node in graph.vs}
    return shape(places, [edge.tuple for edge in graph.es])


def read_karstnet(folder):
    graph = karstnet.from_nodlink_dat(str(folder / "cave"), verbose=False)
    return shape(graph.pos3d, graph.graph.edges)


def read_csv(folder):
    with open(folder / "cave.csv", newline="") as file:
        rows = [[tuple(row[axis + end] for axis in "xyz") for end in "12"] for row in csv.DictReader(file)]
    return shape({place: place for row in rows for place in row}, rows)


def read_graphviz(folder):
    """Draws the plan; ten points to the metre, as Graphviz has placed them, beside the height that it carries along."""
    text = subprocess.run(["neato", "-n", "-Tjson", folder / "cave.dot"], check=True, capture_output=True).stdout
    drawing = json.loads(text)
    places = {}
    for node in drawing["objects"]:
        places[node["_gvid"]] = [float(x) / 10 for x in node["pos"].split(",")] + [float(node["z"])]
    # Graphviz moves the drawing to the corner of the page.
    first = json.loads((folder / "cave.json").read_text())["nodes"][0]["coordinates"]
    offset = [first[axis] - at for axis, at in zip("xyz", places[0], strict=True)]
    moved = {name: [at + by for at, by in zip(place, offset, strict=True)] for name, place in places.items()}
    return shape(moved, [(edge["tail"], edge["head"]) for edge in drawing["edges"]])


READERS = [read_networkx, read_igraph, read_karstnet, read_csv, read_graphviz]
FILES = ["cave.json", "cave.graphml", "cave.csv", "cave.dot", "cave_nodes.dat"]


def export(plume, recipe, folder):
    """The graph of a recipe, in every format."""
    run = [plume, "--quiet", "graph"]
    subprocess.run([*run, recipe, "--output", folder / "cave"], check=True)
    for file in FILES:
        subprocess.run([*run, "export", folder / "cave", "--output", folder / file], check=True)


def is_same(found, expected, tolerance_mm):
    """Whether there are as many places and passages, and no place is off."""
    if tolerance_mm == 0:
        return found == expected
    worst = max(
        min(max(abs(a - b) for a, b in zip(one, other, strict=True)) for other in expected[0]) for one in found[0]
    )
    return [len(part) for part in found] == [len(part) for part in expected] and worst <= tolerance_mm


def agreeing(folder, expected):
    """The readers that agree."""
    # Graphviz writes five digits, of the place and of the offset.
    tolerances = {read_graphviz: 10}
    return [read for read in READERS if is_same(read(folder), expected, tolerances.get(read, 0))]


def main(plume, recipes):
    passages = 0
    for recipe in recipes:
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            export(plume, recipe, folder)
            expected = truth(folder)
            if strangers := set(READERS) - set(agreeing(folder, expected)):
                raise SystemExit(f"{recipe}: other places or passages: {sorted(read.__name__ for read in strangers)}")
            passages += len(expected[1])
            expected[1].pop()
            if blind := agreeing(folder, expected):
                raise SystemExit(f"{recipe}: a passage too many, and nothing said: {[read.__name__ for read in blind]}")
    print(f"{len(recipes)} graphs, {passages} passages: the same in {len(READERS)} readers of {len(FILES) - 1} formats")


main(sys.argv[1], sys.argv[2:])
