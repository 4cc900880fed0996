"""The command line: `lss`, or `python -m lss`."""

import signal
import sys

from . import _lss


def main() -> int:
    """Run the command line with this process's arguments; its exit code."""
    # Ctrl-C is the program's own affair, as in the binary: Python would only hear of it when the work is done.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _lss.main(["lss", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
