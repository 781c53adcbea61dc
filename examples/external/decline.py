"""A decline, the ramp of a mine, that winds down with drifts to all sides: an example for the generator `external`.

`plume generate examples/external/decline.toml --allow-run`. Reads the seed and the settings of the recipe from standard
input, and writes the graph to standard output.
"""

import json
import math
import random
import sys

STATION_M = 4.0


class Mine:
    """Stations, each with those that it leads on to."""

    def __init__(self, settings):
        self.settings, self.nodes = settings, []

    def dig(self, place, before=None):
        """A station with the section of a drift, and a passage to it."""
        number = len(self.nodes)
        section = {"width_m": self.settings["width_m"], "height_m": self.settings["height_m"]}
        coordinates = dict(zip("xyz", place, strict=True))
        self.nodes.append({"id": number, "edges": [], "coordinates": coordinates, "section": section})
        if before is not None:
            self.nodes[before]["edges"].append(number)
        return number

    def decline(self, dice):
        """Down, turn by turn."""
        radius, drop = self.settings["radius_m"], self.settings["drop_m"]
        steps = math.ceil(2 * math.pi * radius / STATION_M)
        at = None
        for step in range(self.settings["turns"] * steps + 1):
            angle = 2 * math.pi * step / steps
            at = self.dig((radius * math.cos(angle), radius * math.sin(angle), -drop * step / steps), at)
            if step % (2 * steps // 3) == steps // 3:
                self.drift(at, angle + dice.uniform(-0.3, 0.3), dice)

    def drift(self, start, angle, dice):
        """Away from the ramp, level, with cross-cuts to either side."""
        stations = round(self.settings["drift_m"] * dice.uniform(0.7, 1.3) / STATION_M)
        at = start
        for number in range(1, stations + 1):
            at = self.heading(at, angle)
            if number % 4 == 0:
                cut, side = at, angle + dice.choice((-1, 1)) * math.pi / 2
                for _ in range(dice.randint(2, 5)):
                    cut = self.heading(cut, side)

    def heading(self, before, angle):
        """A station further on."""
        x, y, z = self.nodes[before]["coordinates"].values()
        return self.dig((x + STATION_M * math.cos(angle), y + STATION_M * math.sin(angle), z), before)


told = json.load(sys.stdin)
mine = Mine(told["settings"])
mine.decline(random.Random(told["seed"]))
json.dump({"nodes": mine.nodes}, sys.stdout)
