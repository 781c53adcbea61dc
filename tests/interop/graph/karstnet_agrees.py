"""Holds `plume measure` to karstnet, the program behind the statistics of real caves: `karstnet_agrees.py PLUME_PROGRAM`.

The same graphs, as files, go to both: those of every generator that needs no file of its own, and shapes that are hard to
reduce: rings, parallel branches, branches of one passage, parts that nothing joins, shafts. Every metric must agree to 1e-9,
but for classes: a length or an azimuth on the border of two may fall to either side for its last bit, so no made-up graph has
its lengths at tenths of the longest by design. At the end one station is moved for one of the two, and they must differ.
"""

import json
import random
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path

import karstnet
import numpy as np

TOLERANCE = 1e-9
# Names of `plume measure`, and karstnet's.
NAMES = {
    "length_entropy": "length entropy",
    "length_variation": "cv length",
    "tortuosity": "tortuosity",
    "orientation_entropy": "orientation entropy",
    "mean_degree": "mean degree",
    "degree_variation": "cv degree",
    "degree_correlation": "correlation vertex degree",
    "central_point_dominance": "cpd",
    "mean_branch_length": "mean length",
    "average_path": "aspl",
}
SEEDS = range(1, 7)
SIZES = (30, 120, 300)


class Comparison:
    """Measures graphs both ways."""

    def __init__(self, plume, folder):
        self.plume, self.folder = plume, Path(folder)
        self.count, self.worst = 0, 0.0

    def run(self, *arguments):
        return subprocess.run([self.plume, *map(str, arguments)], capture_output=True, text=True, check=False)

    def ours(self, path):
        done = self.run("measure", path, "--parts", "keep", "--json")
        if done.returncode != 0:
            raise SystemExit(f"{path.name}: {done.stderr}")
        graph = json.loads(done.stdout)["graph"]
        values = {name: cell["value"] for name, cell in graph["metrics"].items()}
        return values, graph

    def compare(self, path):
        """The greatest difference on one graph."""
        edges, places = read(path)
        ours, _ = self.ours(path)
        theirs, loops = measured(edges, places)
        worst = max(abs(ours[name] - theirs[known]) for name, known in NAMES.items())
        if worst > TOLERANCE or ours["loops"] != loops:
            for name, known in NAMES.items():
                print(f"  {name:26} {ours[name]:.12f} {theirs[known]:.12f}", file=sys.stderr)
            raise SystemExit(f"{path.name}: plume and karstnet differ; loops {ours['loops']} and {loops}")
        self.count, self.worst = self.count + 1, max(self.worst, worst)


def read(path):
    """Edges and places of a graph file."""
    nodes = json.loads(path.read_text())["nodes"]
    places = {node["id"]: [node["coordinates"][axis] for axis in "xyz"] for node in nodes}
    edges = {tuple(sorted((node["id"], other))) for node in nodes for other in node["edges"]}
    return sorted(edges), places


def measured(edges, places):
    """The results of karstnet, and the loops of its reduced graph."""
    with warnings.catch_warnings():
        # The mean of no tortuosity, where all branches are rings.
        warnings.simplefilter("ignore")
        graph = karstnet.KGraph(edges, places, verbose=False)
        metrics = graph.characterize_graph()
    if np.isnan(metrics["tortuosity"]):
        metrics["tortuosity"] = 1.0
    reduced = graph.graph_simpl
    parts = karstnet.base.nx.number_connected_components(reduced)
    return metrics, reduced.number_of_edges() - reduced.number_of_nodes() + parts


def write(path, edges, places):
    """A graph file."""
    neighbors = [[] for _ in places]
    for a, b in edges:
        neighbors[a].append(b)
        neighbors[b].append(a)
    nodes = [
        {"id": i, "edges": neighbors[i], "coordinates": dict(zip("xyz", map(float, place), strict=True)), "radius": 1.0}
        for i, place in enumerate(places)
    ]
    path.write_text(json.dumps({"plume": "0", "nodes": nodes}))


class Drawing:
    """A graph under construction, with stations at random whole millimetres."""

    def __init__(self, seed):
        self.dice, self.places, self.edges = random.Random(seed), [], []

    def station(self):
        self.places.append([round(self.dice.uniform(-99, 99), 3) for _ in range(3)])
        return len(self.places) - 1

    def branch(self, start, end, inner):
        """A branch with this many inner stations; ends that are None are new."""
        start = self.station() if start is None else start
        last = start
        for _ in range(inner):
            fresh = self.station()
            self.edges.append((last, fresh))
            last = fresh
        end = self.station() if end is None else end
        self.edges.append((last, end))
        return start, end

    def tree(self, branches):
        _, tip = self.branch(None, None, 2)
        ends = [0, tip]
        for _ in range(branches):
            _, tip = self.branch(self.dice.choice(ends), None, self.dice.randrange(6))
            ends.append(tip)
        return ends

    def network(self, branches, loops):
        ends = self.tree(branches)
        for _ in range(loops):
            self.branch(*self.dice.sample(ends, 2), self.dice.randrange(1, 5))
        return ends


def shapes():
    """Names and drawings."""
    for name, inner in [("passage", 0), ("line", 7)]:
        drawing = Drawing(inner)
        drawing.branch(None, None, inner)
        yield name, drawing
    for stations in (3, 4, 5, 11):
        drawing = Drawing(stations)
        start, end = drawing.branch(None, None, stations - 2)
        drawing.edges.append((start, end))
        yield f"ring of {stations}", drawing
    for rings in (1, 2, 3):
        drawing = Drawing(rings)
        knot, _ = drawing.branch(None, None, 3)
        for ring in range(rings):
            drawing.branch(knot, knot, 2 + 3 * ring)
        yield f"{rings} rings on a stalk", drawing
    for parallels in (2, 3, 4):
        drawing = Drawing(parallels)
        a, b = drawing.branch(None, None, 0)
        for branch in range(1, parallels):
            drawing.branch(a, b, 2 * branch - 1)
        drawing.branch(a, None, 2)
        yield f"{parallels} parallels, one of them short", drawing
    for size in (5, 10, 20, 40, 80):
        drawing = Drawing(size)
        drawing.tree(size)
        yield f"tree of {size}", drawing
        drawing = Drawing(size)
        drawing.network(size, 1 + size // 4)
        yield f"network of {size}", drawing
    drawing = Drawing(1)
    hub = drawing.station()
    for _ in range(5):
        drawing.branch(hub, None, 1)
    yield "star", drawing
    drawing = Drawing(2)
    drawing.network(12, 3)
    for place in drawing.places[::2]:
        place[:2] = [0.0, 0.0]
    yield "shafts", drawing
    drawing = Drawing(3)
    drawing.network(14, 4)
    for place in drawing.places:
        place[2] = 0.0
    yield "level", drawing


def parts():
    """Drawings that hang together nowhere."""
    for seed in range(5):
        drawing = Drawing(100 + seed)
        drawing.network(10 + seed, 2)
        drawing.branch(None, None, seed)
        start, end = drawing.branch(None, None, 2 + seed)
        drawing.edges.append((start, end))
        yield f"parts {seed}", drawing


def grown(comparison):
    """Graphs of every generator that needs no file or program."""
    rows = json.loads(comparison.run("list", "generators", "--json").stdout)["generators"]
    for row in rows:
        for seed in SEEDS:
            folder = comparison.folder / f"{row['name']}-{seed}"
            size = SIZES[seed % len(SIZES)]
            make = ["graph", "--quiet", "--seed", seed, "--output", folder, "--set", f"graph.generator={row['name']}"]
            # The layers generator has no setting for the number of nodes.
            if any(comparison.run(*make, *more).returncode == 0 for more in (["--set", f"graph.nodes={size}"], [])):
                yield folder / "graph.json"


def must_notice(comparison, path):
    """One station moved by a metre for karstnet alone."""
    edges, places = read(path)
    ours, _ = comparison.ours(path)
    places[edges[0][0]][0] += 1.0
    theirs, _ = measured(edges, places)
    if abs(ours["mean_branch_length"] - theirs["mean length"]) <= TOLERANCE:
        raise SystemExit("a station was moved, and nothing changed")


def main():
    with tempfile.TemporaryDirectory() as folder:
        comparison = Comparison(sys.argv[1], folder)
        paths = list(grown(comparison))
        grown_count = len(paths)
        for name, drawing in [*shapes(), *parts()]:
            paths.append(comparison.folder / f"{name}.json")
            write(paths[-1], drawing.edges, drawing.places)
        for path in paths:
            comparison.compare(path)
        if grown_count < 2 * len(SEEDS):
            raise SystemExit(f"only {grown_count} graphs were grown")
        must_notice(comparison, paths[0])
    print(
        f"{comparison.count} graphs, {len(NAMES) + 1} metrics each: plume and karstnet agree to {comparison.worst:.0e}"
    )


if __name__ == "__main__":
    main()
