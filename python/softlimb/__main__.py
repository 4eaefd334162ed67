"""``python -m softlimb``: the command."""

import signal
import sys

from softlimb import _native


def main() -> int:
    """Runs the command with the words of this process; its exit code."""
    # Python would note Ctrl-C and wait for the native part to end.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _native.main(["softlimb", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
