"""The marker in every package of the sample, read by every reader that shares one Python.

orientation.py SAMPLE_DIR
"""

import gltf
import marker
import meshes
import mjcf
import usd
from packages import run

if __name__ == "__main__":
    run(marker.verify, [*meshes.READERS, *gltf.READERS, *usd.READERS, *mjcf.READERS])
