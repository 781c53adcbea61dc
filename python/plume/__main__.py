"""The `plume` command."""

import sys

from plume import _plume


def main() -> int:
    """Runs the command line of this process and gives its exit code."""
    return _plume.main(["plume", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
