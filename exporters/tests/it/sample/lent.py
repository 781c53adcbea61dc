"""Runs functions of the USD script, which is the first argument: one call per line of JSON, arrays in separate files."""

import json
import sys
from pathlib import Path

import numpy as np


def array(file, kind, width):
    numbers = np.fromfile(file, dtype=kind)
    return numbers.reshape(-1, width) if width > 1 else numbers


script = {"__name__": "stage"}
exec(compile(sys.argv[1], "stage.py", "exec"), script)
for line in sys.stdin:
    call = json.loads(line)
    arrays = {
        name: array(Path(call["folder"]) / str(number), kind, width)
        for number, (name, kind, width) in enumerate(call["arrays"])
    }
    try:
        script[call["function"]](call["spec"], arrays)
        print("done", flush=True)
    except Exception as fault:
        print(repr(fault).replace("\n", " "), flush=True)
