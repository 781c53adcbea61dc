"""Opens exported graphs with networkx, igraph, karstnet and Graphviz: read.py FOLDER

The folder holds one graph as `cave.json`, `cave.graphml`, `cave.csv`, `cave.dot` and `cave_nodes.dat` with `cave_links.dat`, as
`plume graph export` writes them. Each reader must see the same places and passages as the JSON, to 1 mm, and types that are numbers.
"""

import csv
import json
import subprocess
import sys
from pathlib import Path

import igraph
import karstnet
import networkx


def millimetres(place):
    return tuple(round(1000 * float(x)) for x in place)


def shape(places, passages):
    """Places in whole millimetres, and the passages between them."""
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


READERS = [read_networkx, read_igraph, read_karstnet, read_csv]


def main(folder):
    places, passages = truth(folder)
    for read in READERS:
        found = read(folder)
        assert found[0] == places, f"{read.__name__}: other places: {sorted(found[0] ^ places)[:4]}"
        assert found[1] == passages, f"{read.__name__}: other passages: {len(found[1])}, not {len(passages)}"
    # Graphviz writes five digits, of the place and of the offset.
    drawn, lines = read_graphviz(folder)
    assert (len(drawn), len(lines)) == (len(places), len(passages)), "read_graphviz: other counts"
    near = max(min(max(abs(a - b) for a, b in zip(one, other, strict=True)) for other in places) for one in drawn)
    assert near <= 10, f"read_graphviz: a place is {near} mm off"
    print(f"{len(places)} places and {len(passages)} passages, the same in {len(READERS) + 1} readers")


main(Path(sys.argv[1]))
