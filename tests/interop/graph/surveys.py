"""Holds `plume graph import` to Survex and Therion: `surveys.py PLUME_PROGRAM`.

Caves are drawn, surveyed with small errors, and written down as Survex, Therion and Compass books, in other units and with
corrections from cave to cave. `cavern` and `therion` close the loops their way; every leg that they place must be a passage
of the imported graph, with both ends within a centimetre or two, as fine as Survex writes. At the end one leg is written a metre longer for one of the two,
and they must differ.
"""

import json
import math
import random
import re
import subprocess
import sys
import tempfile
from pathlib import Path

CAVES = range(1, 7)
STATIONS = 60
LOOPS = 8
FOOT_M = 0.3048
YARD_M = 0.9144
# A line of a leg: two stations and at least three numbers.
LEG = re.compile(r"\S+ \S+( -?[0-9.]+){3}")


class Cave:
    """Stations, and legs between them as (from, to, tape in m, compass and clino in degrees)."""

    def __init__(self, seed):
        self.dice, self.places, self.legs = random.Random(seed), [(0.0, 0.0, 0.0)], []
        self.declination = round(self.dice.uniform(-8, 8), 1)
        for fresh in range(1, STATIONS):
            start = self.dice.randrange(max(0, fresh - 6), fresh)
            length, pitch = self.dice.uniform(2, 25), math.radians(self.dice.gauss(0, 20))
            yaw = self.dice.uniform(0, 2 * math.pi)
            way = (math.sin(yaw) * math.cos(pitch), math.cos(yaw) * math.cos(pitch), math.sin(pitch))
            self.places.append(tuple(at + length * x for at, x in zip(self.places[start], way, strict=True)))
            self.survey(start, fresh)
        joined = {frozenset(leg[:2]) for leg in self.legs}
        while len(self.legs) < STATIONS - 1 + LOOPS:
            ends = self.dice.sample(range(STATIONS), 2)
            if frozenset(ends) not in joined:
                joined.add(frozenset(ends))
                self.survey(*ends)

    def survey(self, start, end):
        """Reads a leg as people do: to the centimetre and half a degree, from either end."""
        if self.dice.random() < 0.3:
            start, end = end, start
        x, y, z = (b - a for a, b in zip(self.places[start], self.places[end], strict=True))
        tape = math.hypot(x, y, z) + self.dice.gauss(0, 0.02)
        compass = math.degrees(math.atan2(x, y)) - self.declination + self.dice.gauss(0, 0.5)
        clino = math.degrees(math.atan2(z, math.hypot(x, y))) + self.dice.gauss(0, 0.5)
        self.legs.append((start, end, round(tape, 2), round(2 * (compass % 360)) / 2 % 360, round(2 * clino) / 2))


def part_of(station):
    """The survey that a station belongs to."""
    return "abc"[station * 3 // STATIONS]


def split(cave):
    """The legs inside each of three surveys, and those between them."""
    inside = {part: [leg for leg in cave.legs if {part_of(leg[0]), part_of(leg[1])} == {part}] for part in "abc"}
    between = [leg for leg in cave.legs if part_of(leg[0]) != part_of(leg[1])]
    return inside, between


def survex(cave):
    feet, grads = cave.dice.random() < 0.5, cave.dice.random() < 0.5
    metres, degrees = FOOT_M if feet else 1.0, 0.9 if grads else 1.0
    inside, between = split(cave)

    def line(leg, name):
        start, end, tape, compass, clino = leg
        return f"{name(start)} {name(end)} {tape / metres - 0.2:.4f} {compass / degrees:.4f} {clino}"

    lines = ["*begin cave", "*fix a.0 0 0 0", "*entrance a.0", f"*declination {cave.declination} degrees"]
    lines += [f"*units tape {'feet' if feet else 'metres'}", f"*units compass {'grads' if grads else 'degrees'}"]
    # What an instrument shows at zero, in its unit.
    lines += ["*calibrate tape -0.2"]
    for part, legs in inside.items():
        lines += [f"*begin {part}", *(line(leg, str) for leg in legs), f"*end {part}"]
    lines += [line(leg, lambda station: f"{part_of(station)}.{station}") for leg in between]
    return {"cave.svx": "\n".join([*lines, "*end cave", ""])}


def therion(cave):
    inside, between = split(cave)
    yards = cave.dice.random() < 0.5
    metres = YARD_M if yards else 1.0

    def centreline(legs, name):
        head = [f"declination {cave.declination} deg", f"units length {'yards' if yards else 'metres'}"]
        rows = [f"{name(a)} {name(b)} {tape / metres:.4f} {compass} {clino}" for a, b, tape, compass, clino in legs]
        return ["centreline", *head, "data normal from to length compass clino", *rows, "endcentreline"]

    lines = ["encoding utf-8", "survey cave"]
    for part, legs in inside.items():
        lines += [f"survey {part}", *centreline(legs, str), f"endsurvey {part}"]
    lines += ["centreline", "fix 0@a 0 0 0", 'station 0@a "" entrance', "endcentreline"]
    lines += centreline(between, lambda station: f"{station}@{part_of(station)}")
    return {
        "cave.th": "\n".join([*lines, "endsurvey", ""]),
        "thconfig": "source cave.th\nexport model -fmt survex -o cave.3d\n",
    }


def compass(cave):
    lines = ["CAVE", "SURVEY NAME: A", "SURVEY DATE: 7 14 2001  COMMENT:", "SURVEY TEAM:", "Nobody"]
    lines += [f"DECLINATION: {cave.declination:.2f}  FORMAT: DDDDLUDRLADN  CORRECTIONS: 1.00 -0.50 0.00", ""]
    lines += ["FROM TO LENGTH BEARING INC LEFT UP DOWN RIGHT FLAGS COMMENTS", ""]
    for start, end, tape, bearing, clino in cave.legs:
        # Corrections are added: bearing, inclination, length.
        reading = f"{tape / FOOT_M:.2f} {(bearing - 1) % 360:.2f} {clino + 0.5:.2f}"
        lines.append(f"A{start} A{end} {reading} -9.90 -9.90 -9.90 -9.90")
    project = "@0.0,0.0,0.0,32,0.0;\r\n&WGS 1984;\r\n#cave.dat,A0[m,0.0,0.0,0.0];\r\n"
    return {"cave.mak": project, "cave.dat": "\r\n".join([*lines, "\f", ""])}


class Format:
    """How a cave is written: the files, the one to open, the one with the legs, and the program that places them."""

    def __init__(self, write, opened, legs, program, tolerance_m):
        self.write, self.opened, self.legs = write, opened, legs
        self.program, self.tolerance_m = program, tolerance_m


FORMATS = [
    Format(survex, "cave.svx", "cave.svx", ["cavern", "-q", "cave.svx"], 0.01),
    Format(therion, "cave.th", "cave.th", ["therion", "thconfig"], 0.01),
    # Survex weights the loops of Compass data differently.
    Format(compass, "cave.mak", "cave.dat", ["cavern", "-q", "cave.mak"], 0.02),
]


def placed(folder, program):
    """The legs as the other program places them."""
    done = subprocess.run(program, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"{program[0]} refuses its cave: {done.stdout[-2000:]}{done.stderr[-500:]}")
    dump = subprocess.run(["dump3d", "--legs", "cave.3d"], cwd=folder, capture_output=True, check=True).stdout
    legs = [line.split()[1:7] for line in dump.decode("latin-1").splitlines() if line.startswith("LEG ")]
    return [(tuple(map(float, leg[:3])), tuple(map(float, leg[3:]))) for leg in legs]


def imported(plume, path):
    """Places and passages of the graph, in the coordinates of the survey."""
    output = path.with_suffix(".json")
    command = [plume, "--json", "graph", "import", path, "-o", output, "--force"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"plume refuses {path.name}: {done.stderr}")
    origin = json.loads(done.stdout)["tally"]["origin_m"]
    nodes = json.loads(output.read_text())["nodes"]
    places = [[node["coordinates"][axis] + by for axis, by in zip("xyz", origin, strict=True)] for node in nodes]
    return places, {frozenset((node["id"], other)) for node in nodes for other in node["edges"]}


def worst_of(legs, places, passages):
    """Maximum distance between the ends of passages and legs; infinite if a leg has no passage."""
    worst, found = 0.0, set()
    for leg in legs:
        nearest = [min((math.dist(end, place), node) for node, place in enumerate(places)) for end in leg]
        worst = max(worst, *(away for away, _ in nearest))
        found.add(frozenset(node for _, node in nearest))
    return worst if found == passages else math.inf


def compare(plume, seed, form, change=lambda text: text):
    """The greatest difference on one cave."""
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        files = form.write(Cave(seed))
        for name, text in files.items():
            (folder / name).write_text(text, newline="")
        legs = placed(folder, form.program)
        (folder / form.legs).write_text(change(files[form.legs]), newline="")
        return worst_of(legs, *imported(plume, folder / form.opened))


def longer(text):
    """The same book with a metre more on one of its last legs."""
    lines = text.split("\n")
    place = max(number for number, line in enumerate(lines) if LEG.match(line))
    words = lines[place].split(" ")
    words[2] = str(float(words[2]) + 1)
    return "\n".join([*lines[:place], " ".join(words), *lines[place + 1 :]])


def main(plume):
    found = []
    for form in FORMATS:
        worst = max(compare(plume, seed, form) for seed in CAVES)
        if worst > form.tolerance_m:
            raise SystemExit(f"{form.opened}: a station is {worst:.3f} m off")
        if compare(plume, 1, form, longer) <= form.tolerance_m:
            raise SystemExit(f"{form.opened}: a leg that is a metre longer makes no difference")
        found.append(f"{form.opened} {1000 * worst:.0f} mm")
    legs = len(CAVES) * len(FORMATS) * (STATIONS - 1 + LOOPS)
    print(f"{legs} legs stand where cavern and therion place them, loops closed: at most {', '.join(found)} off")


main(sys.argv[1])
