"""What there is to see in a recording: corners, and how many features are found again a second later where they should be.

The count of corners says little of a texture: one that repeats itself has many, which are mistaken for each other.
"""

import cv2
import numpy as np

EVERY = 20  # frames
LATER = 10
THRESHOLD = 20  # grey levels, as ORB-SLAM3 begins with
FEATURES = 1000
RATIO = 0.8  # of the distances to the best and the second best match (Lowe 2004)
WITHIN_PX = 4.0


def features(recording):
    """Medians over the recording: corners, features matched where they should be, and their share of all matches."""
    numbers = range(0, len(recording.times) - LATER, EVERY)
    fast = cv2.FastFeatureDetector_create(THRESHOLD)
    corners = [len(fast.detect(recording.grey(number))) for number in numbers]
    seen = Seen(recording)
    found = np.array([seen.again(number) for number in numbers])
    inliers, matches = found.T
    return {
        "corners": float(np.median(corners)),
        "inliers": float(np.median(inliers)),
        "inlier_share": float(np.median(inliers / np.maximum(matches, 1))),
    }


class Seen:
    """Frames with their true poses, and matches between them."""

    def __init__(self, recording):
        self.recording = recording
        fx, fy, cx, cy, self.units_per_m = recording.numbers(
            "Camera1.fx", "Camera1.fy", "Camera1.cx", "Camera1.cy", "RGBD.DepthMapFactor"
        )
        self.focal, self.centre = np.array([fx, fy]), np.array([cx, cy])
        truth = recording.truth()
        self.poses = dict(zip(truth.timestamps.round(6), truth.poses_se3, strict=True))
        self.orb = cv2.ORB_create(FEATURES, 1.2, 8, fastThreshold=7)
        self.matcher = cv2.BFMatcher(cv2.NORM_HAMMING)

    def again(self, number):
        """How many features are where they should be later, and how many are matched at all."""
        (one, told), (other, told_later) = self.described(number), self.described(number + LATER)
        if told is None or told_later is None:
            return 0, 0
        pairs = [pair for pair in self.matcher.knnMatch(told, told_later, 2) if len(pair) == 2]
        pairs = [best for best, second in pairs if best.distance < RATIO * second.distance]
        if not pairs:
            return 0, 0
        places, is_seen = self.moved(number, one[[pair.queryIdx for pair in pairs]])
        apart = np.linalg.norm(places - other[[pair.trainIdx for pair in pairs]], axis=1)
        return int((apart[is_seen] < WITHIN_PX).sum()), int(is_seen.sum())

    def described(self, number):
        points, told = self.orb.detectAndCompute(self.recording.grey(number), None)
        return np.array([point.pt for point in points]).reshape(-1, 2), told

    def moved(self, number, pixels):
        """Where these pixels of a frame are later, and which of them the depth camera sees."""
        x, y = np.round(pixels).astype(int).T
        depth_m = self.recording.depth(number)[y, x] / self.units_per_m
        rays = np.column_stack([(pixels - self.centre) / self.focal, np.ones(len(pixels))])
        between = np.linalg.inv(self.pose(number + LATER)) @ self.pose(number)
        there = (rays * depth_m[:, None]) @ between[:3, :3].T + between[:3, 3]
        is_seen = (depth_m > 0) & (there[:, 2] > 0)
        return there[:, :2] / np.where(is_seen, there[:, 2], 1)[:, None] * self.focal + self.centre, is_seen

    def pose(self, number):
        return self.poses[round(float(self.recording.times[number]), 6)]
