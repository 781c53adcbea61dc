"""How a robot that steers like a tank pursues a point that moves ahead of it on a line."""

import numpy as np

SPEED_M_S = 0.5
TURN_GAIN = 3.0  # rad/s for each rad off course; tuned: skidding wheels turn less than they are told
TURN_MOST_RAD_S = 1.5  # also on the spot: slowly, wheels that skid do not turn it at all
SPOT_RAD = 0.35  # further off course it stops to turn: a tank pivots on inner wheels that all but stand still no longer
AHEAD_RAD = 0.1  # and until it is as near to its course: otherwise it dithers between both, and slips down slopes
CONTROL_S = 0.1
STUCK_S = 10.0
LEAN_DEG = 50.0


class Pursuit:
    """Of a point, which may be another one in each command."""

    def __init__(self, robot):
        self.robot, self.is_turning = robot, False

    def steer(self, target):
        """Turns towards a point, on the spot if it is far off course, until it is time for the next command."""
        ahead, left, _ = self.robot.axes.T
        away = target - self.robot.position
        off_course_rad = np.arctan2(away @ left, away @ ahead)
        self.is_turning = abs(off_course_rad) > (AHEAD_RAD if self.is_turning else SPOT_RAD)
        if self.is_turning:
            self.robot.steer(0, np.copysign(TURN_MOST_RAD_S, off_course_rad))
        else:
            turn_rad_s = np.clip(TURN_GAIN * off_course_rad, -TURN_MOST_RAD_S, TURN_MOST_RAD_S)
            self.robot.steer(SPEED_M_S * np.cos(off_course_rad) ** 2, turn_rad_s)
        self.robot.run(CONTROL_S)


def is_tipped(robot):
    return robot.axes[2, 2] < np.cos(np.radians(LEAN_DEG))
