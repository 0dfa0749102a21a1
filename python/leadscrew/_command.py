"""The command ``leadscrew`` that the package brings: the same program, in this process."""

from __future__ import annotations

import signal
import sys


def main() -> int:
    """Do what the words say; the exit code."""
    if sys.argv[1:2] == ["study"]:
        from .study._command import main as study

        return study(sys.argv[2:])
    from . import _leadscrew as native

    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Python's handler would only note it
    sys.stdout.flush()
    return native.main(["leadscrew", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
