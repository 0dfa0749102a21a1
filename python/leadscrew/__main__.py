"""``python -m leadscrew`` is the command ``leadscrew``."""

import sys

from ._command import main

sys.exit(main())
