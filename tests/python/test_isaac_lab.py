"""What the example for Isaac Lab reads of a package; Isaac Lab itself is not run."""

import json
import runpy
from pathlib import Path

import numpy as np

EXAMPLE = runpy.run_path(str(Path(__file__).parents[2] / "examples/python/isaac_lab_terrain.py"))


def test_start_poses_are_those_of_the_manifest(packages):
    expected = json.loads((packages / "isaac/manifest.json").read_text(encoding="utf-8"))["spawns"]
    positions, turns = EXAMPLE["start_poses"](packages / "isaac/cave.usda")
    assert len(expected) > 0
    assert np.allclose(positions, [spawn["position"] for spawn in expected], rtol=0, atol=1e-9)
    assert same_turns(turns, np.array([spawn["orientation_wxyz"] for spawn in expected]))


def same_turns(one, other):
    """A quaternion and its negative are the same turn."""
    return np.allclose(np.abs((one * other).sum(axis=1)), 1, rtol=0, atol=1e-9)
