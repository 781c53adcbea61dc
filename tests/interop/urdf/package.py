"""A URDF package as the checks see it, without any reader of URDF."""

import os
import sys
from pathlib import Path

import numpy as np


class Failure(Exception):
    """What is wrong with a package."""


def require(truth, message):
    if not truth:
        raise Failure(message)


def urdf_of(package):
    """The one URDF of the package."""
    found = sorted(package.glob("*/urdf/*.urdf"))
    require(len(found) == 1, f"expected one */urdf/*.urdf in {package}, found {len(found)}")
    return found[0]


class Obj:
    """Lines of an OBJ file, counted."""

    def __init__(self, path):
        lines = [line.split() for line in Path(path).read_text().splitlines()]
        points = np.array([line[1:4] for line in lines if line and line[0] == "v"], dtype=np.float64)
        self.triangles = sum(line[0] == "f" for line in lines if line)
        self.bounds = np.array([points.min(axis=0), points.max(axis=0)])


def run(verify):
    """Runs a check on the package that the command line names; its summary goes to stdout, failures to stderr, and with them
    whatever the reader itself prints."""
    with os.fdopen(os.dup(1), "w") as stdout:
        os.dup2(2, 1)
        try:
            print(verify(Path(sys.argv[1]), *sys.argv[2:]), file=stdout)
        except Failure as failure:
            sys.exit(f"error: {failure}")
