"""The floor of a cave, by the field that it was made from."""

import numpy as np

PROBED_M = 0.5
STEP_M = 0.005


def heights_m(cave, points):
    """How high points are over the floor of an open cave, straight below or above them; infinite if there is none near."""
    steps_m = np.arange(PROBED_M, -PROBED_M, -STEP_M)
    columns = points[:, None] + steps_m[:, None] * [0, 0, 1]
    field_m = cave.field(columns.reshape(-1, 3)).reshape(columns.shape[:2])
    above_m, below_m = field_m[:, :-1], field_m[:, 1:]
    # From the open into the rock; of several floors the one that is next to the point.
    enters = (above_m < 0) & (below_m >= 0)
    share = np.divide(above_m, above_m - below_m, where=enters, out=np.zeros_like(above_m))
    found_m = np.where(enters, share * STEP_M - steps_m[:-1], np.inf)
    return found_m[np.arange(len(points)), np.abs(found_m).argmin(axis=1)]
