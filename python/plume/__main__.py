"""The `plume` command."""

import signal
import sys

from plume import _plume


def main() -> int:
    """Runs the command line of this process and returns its exit code."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        # Plume stops the work itself; Python would raise KeyboardInterrupt on top of that.
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _plume.main(["plume", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
