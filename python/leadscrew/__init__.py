"""Leadscrew: an open numerical control for spindle-synchronised machining.

>>> import leadscrew
>>> result = leadscrew.run("programs/plate-12xM6.ngc", seed=3)
>>> result.passed
True

:func:`check`, :func:`canon`, :func:`time`, :func:`run`, :func:`polygon` and :func:`cam` are the commands of the same names;
their options are the command's. :class:`Machine` is a machine file with values changed. :mod:`leadscrew.study` runs many cases.
Lengths are millimetres or micrometres, times seconds, speeds rev/min: the name of a key, a column or an argument says which.
"""

from ._api import cam, canon, check, polygon, run, time
from ._errors import Diagnostic, Refused
from ._leadscrew import __version__
from ._machine import MACHINES, Machine
from ._result import Event, Result

__all__ = [
    "MACHINES",
    "Diagnostic",
    "Event",
    "Machine",
    "Refused",
    "Result",
    "__version__",
    "cam",
    "canon",
    "check",
    "polygon",
    "run",
    "time",
]
