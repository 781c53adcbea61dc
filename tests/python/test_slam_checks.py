"""What the VSLAM bench makes paths and errors from."""

import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from evo.core.trajectory import PoseTrajectory3D
from evo.tools import file_interface

CHECKS = Path(__file__).parents[1] / "interop/slam"
sys.path.append(str(CHECKS))

import errors  # noqa: E402 - the checks themselves
import lap  # noqa: E402


def there_and_back():
    """Eight metres to a square of six metres, round it, and back."""
    way = np.column_stack([np.arange(0, 8, 0.1), np.zeros(80), np.zeros(80)])
    corners = np.array([[8, 0, 0], [14, 0, 1], [14, 6, 1], [8, 6, 0], [8, 0.1, 0]], dtype=float)
    sides = [np.linspace(one, other, 60, endpoint=False) for one, other in zip(corners, corners[1:], strict=False)]
    return np.concatenate([way, *sides, way[::-1]])


def test_a_lap_goes_round_the_loop_and_over_its_beginning():
    path = there_and_back()
    places, headings = lap.lap(path)
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    assert steps.sum() == pytest.approx(24 + lap.AGAIN_M, abs=1.5)
    assert steps.max() < 1.1 * steps.min(), "the speed is not constant"
    assert np.abs(np.diff(headings)).max() < np.radians(2), "it turns on the spot"
    apart = np.linalg.norm(places[:, None] - path[None], axis=2).min(axis=1)
    assert apart.max() < 0.3
    again = round(lap.AGAIN_M / lap.STEP_M)
    assert np.allclose(places[:again], places[-again:])
    assert np.allclose(np.exp(1j * headings[:again]), np.exp(1j * headings[-again:]))


def test_a_path_there_and_back_has_no_loop():
    with pytest.raises(SystemExit):
        lap.lap(there_and_back()[:80])


def test_errors_are_those_that_were_made(tmp_path):
    """A trajectory that is elsewhere as a whole has none; one that is 3 % too long has 3 cm in a metre."""
    s = np.linspace(0, 20, 201)
    places = np.column_stack([s, np.sin(s / 3), np.zeros(201)])
    turns = np.tile([1.0, 0, 0, 0], (201, 1))
    truth = PoseTrajectory3D(positions_xyz=places, orientations_quat_wxyz=turns, timestamps=s)
    recording = SimpleNamespace(truth=lambda: truth)
    found = {name: tmp_path / f"{name}.tum" for name in ("elsewhere", "long")}
    for name, moved in {"elsewhere": places + [5, -2, 1], "long": places * 1.03}.items():
        told = PoseTrajectory3D(positions_xyz=moved, orientations_quat_wxyz=turns, timestamps=s)
        file_interface.write_tum_trajectory_file(found[name], told)
    assert errors.errors(recording, found["elsewhere"], has_scale=True)["ate_cm"] < 1e-4
    assert errors.errors(recording, found["long"], has_scale=True)["rpe_cm_per_m"] == pytest.approx(3, rel=0.1)
    assert errors.errors(recording, found["long"], has_scale=False)["ate_cm"] < 1e-4
    assert errors.errors(recording, found["long"], has_scale=False)["scale"] == pytest.approx(1 / 1.03)
