"""Studies: a function over a table of cases, on threads, on processes or on a cluster.

>>> from leadscrew import study
>>> cases = study.latin_hypercube({"plant.axes.z.structure.backlash_um": (1, 15)}, n=200, seed=1)
>>> table = study.run(study.Cut("part.ngc"), cases, out="out/backlash")        # doctest: +SKIP

A study that was interrupted goes on where it was: the same call again. Each case has a hash of all that it depends on; what is
in ``out`` with that hash is not run again.
"""

from ._capability import Capability, Interval, capability, wilson
from ._cases import MOST_CASES, full_factorial, latin_hypercube, replicated, sobol
from ._cut import Cut
from ._effects import Effect, effects
from ._executors import dask, processes, threads
from ._run import Progress, WrongVersion, run

__all__ = [
    "MOST_CASES",
    "Capability",
    "Cut",
    "Effect",
    "Interval",
    "Progress",
    "WrongVersion",
    "capability",
    "dask",
    "effects",
    "full_factorial",
    "latin_hypercube",
    "processes",
    "replicated",
    "run",
    "sobol",
    "threads",
    "wilson",
]
