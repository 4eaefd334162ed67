"""``python -m softlimb``: the command."""

import sys

from softlimb import _native


def main() -> int:
    """Runs the command with the words of this process; its exit code."""
    return _native.main(["softlimb", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
