"""A way along the passages of a cave for a rover."""

import numpy as np
from package import require
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

SOON_M = 1.0  # here a route shows which way it goes


class Line:
    """A line from point to point."""

    def __init__(self, corners):
        self.corners = np.asarray(corners)
        steps_m = np.linalg.norm(np.diff(self.corners[:, :2], axis=0), axis=1)
        self.passed_m = np.concatenate([[0], np.cumsum(steps_m)])

    @property
    def length_m(self):
        """Over the ground, as all lengths here."""
        return self.passed_m[-1]

    def at(self, along_m):
        """The point (or points) this far from the start."""
        return np.stack([np.interp(along_m, self.passed_m, axis) for axis in self.corners.T], axis=-1)

    def along_m(self, point, passed_m, reach_m):
        """How far the place on the line is that is next to a point, among those at most `reach_m` further than `passed_m`."""
        places_m = np.linspace(passed_m, min(passed_m + reach_m, self.length_m), 50)
        return places_m[np.linalg.norm((self.at(places_m) - point)[:, :2], axis=1).argmin()]

    @property
    def steepness(self):
        """Rise over run where it is steepest; that of the first step, which starts on the ground, does not count."""
        return (np.abs(np.diff(self.corners[1:, 2])) / np.diff(self.passed_m[1:])).max()


def route(stations, passages, start, ahead, length_m):
    """The most level line along the passages, as long as asked for, without a turn back.

    It goes ahead from the start if any does, so that the rover need not turn on the spot.
    """
    lines = list(ways(stations, passages.tolist(), start, length_m))
    lines = [line for line in lines if (line.at(SOON_M) - start)[:2] @ ahead[:2] > 0] or lines
    require(lines, f"the passages from the start go on for less than {length_m} m")
    return min(lines, key=lambda line: line.steepness)


def longest_route(stations, passages, start):
    """The shortest line along the passages to the station that is furthest from the start."""
    ends = min(passages, key=lambda passage: distance_m(start, *stations[passage]))
    lengths_m = np.linalg.norm(stations[passages[:, 0]] - stations[passages[:, 1]], axis=1)
    graph = coo_array((lengths_m, passages.T), shape=(len(stations), len(stations)))
    to_end_m, before = dijkstra(graph, directed=False, indices=ends, return_predecessors=True)
    from_start_m = to_end_m + np.linalg.norm(stations[ends] - start, axis=1)[:, None]
    nearest_m, side = from_start_m.min(axis=0), from_start_m.argmin(axis=0)
    station = np.where(np.isfinite(nearest_m), nearest_m, -1).argmax()
    chain, row = [], before[side[station]]
    while station >= 0:
        chain.append(station)
        station = row[station]
    return Line([start, *stations[chain[::-1]]])


def ways(stations, passages, start, length_m):
    """Lines from the start over either end of the passage it is in, past each station once."""
    neighbours = {station: [] for station in range(len(stations))}
    for one, other in passages:
        neighbours[one].append(other)
        neighbours[other].append(one)
    ends = min(passages, key=lambda passage: distance_m(start, *stations[passage]))
    # Chains in which the end that is left behind counts as passed.
    chains = [[ends[1], ends[0]], [ends[0], ends[1]]]
    while chains:
        chain = chains.pop()
        line = Line([start, *stations[chain[1:]]])
        if line.length_m >= length_m:
            yield line
            continue
        chains += [[*chain, station] for station in neighbours[chain[-1]] if station not in chain]


def distance_m(point, one, other):
    """How far a point is from the line between two others."""
    step = other - one
    share = np.clip((point - one) @ step / (step @ step), 0, 1)
    return np.linalg.norm(one + share * step - point)
