"""How a robot that steers like a tank pursues a point that moves ahead of it on a line."""

import numpy as np

SPEED_M_S = 0.5
TURN_GAIN = 3.0  # rad/s for each rad off course; tuned: skidding wheels turn less than they are told
TURN_MOST_RAD_S = 1.5
SPOT_RAD = (
    0.35  # further off course it stops to turn: a tank whose inner wheels all but stand still pivots on them no longer
)
CONTROL_S = 0.1
STUCK_S = 10.0
LEAN_DEG = 50.0


def pursue(robot, target):
    """Turns towards a point, on the spot if it is far off course, until it is time for the next command."""
    ahead, left, _ = robot.axes.T
    away = target - robot.position
    off_course_rad = np.arctan2(away @ left, away @ ahead)
    turn_rad_s = np.clip(TURN_GAIN * off_course_rad, -TURN_MOST_RAD_S, TURN_MOST_RAD_S)
    robot.steer(SPEED_M_S * np.cos(off_course_rad) ** 2 * (abs(off_course_rad) < SPOT_RAD), turn_rad_s)
    robot.run(CONTROL_S)


def is_tipped(robot):
    return robot.axes[2, 2] < np.cos(np.radians(LEAN_DEG))
