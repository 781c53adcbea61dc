"""A recording in the layout `tum`, as `plume record` writes it."""

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from evo.tools import file_interface


@dataclass
class Recording:
    folder: Path
    times: list[str]

    @classmethod
    def read(cls, folder):
        lines = (folder / "rgb.txt").read_text(encoding="ascii").splitlines()
        return cls(folder, [line.split()[0] for line in lines if not line.startswith("#")])

    @property
    def settings(self):
        """For ORB-SLAM3."""
        return self.folder / "orbslam3.yaml"

    def grey(self, number, camera="."):
        return cv2.imread(str(self.folder / camera / f"rgb/{self.times[number]}.png"), cv2.IMREAD_GRAYSCALE)

    def depth(self, number):
        """In units of the file, 0 where there is none."""
        return cv2.imread(str(self.folder / f"depth/{self.times[number]}.png"), cv2.IMREAD_UNCHANGED).astype(np.float32)

    def truth(self):
        return file_interface.read_tum_trajectory_file(self.folder / "groundtruth.txt")

    def numbers(self, *keys):
        """Numbers of the settings."""
        file = cv2.FileStorage(str(self.settings), cv2.FILE_STORAGE_READ)
        return [file.getNode(key).real() for key in keys]
