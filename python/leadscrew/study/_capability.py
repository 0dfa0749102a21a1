"""Capability of a process: Cp, Cpk and the share out of tolerance, each with its interval.

Sources: D. C. Montgomery, *Introduction to Statistical Quality Control*, ch. 8 (Cp: χ²; Cpk: Bissell's normal approximation);
for one limit the interval is exact by the noncentral t distribution (Kotz & Johnson, *Process Capability Indices*, ch. 2);
E. B. Wilson, JASA 22 (1927) for shares.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Interval:
    """From ``low`` to ``high``, with the confidence that was asked."""

    low: float
    high: float

    def __contains__(self, value: float) -> bool:
        return self.low <= value <= self.high


@dataclass(frozen=True, slots=True)
class Capability:
    """What ``n`` values say of a process, in their unit. ``cp`` needs both limits, ``None`` without."""

    n: int
    mean: float
    standard_deviation: float
    lower: float | None
    upper: float | None
    cp: float | None
    cp_interval: Interval | None
    cpk: float
    cpk_interval: Interval
    out: int
    out_share: float
    out_interval: Interval
    confidence: float


def capability(
    values: Sequence[float] | Any, *, lower: float | None = None, upper: float | None = None, confidence: float = 0.95
) -> Capability:
    """Capability of ``values`` (1-d, finite, at least 2, not all equal) against one or both limits."""
    import numpy as np
    from scipy import stats

    x = np.asarray(values, dtype=float)
    if x.ndim != 1 or len(x) < 2 or not np.isfinite(x).all():
        raise ValueError(f"capability: expected at least 2 finite values in one dimension, found shape {x.shape}")
    if lower is None and upper is None:
        raise ValueError("capability: expected a lower or an upper limit")
    if lower is not None and upper is not None and not lower < upper:
        raise ValueError(f"capability: expected lower < upper, found {lower} and {upper}")
    if not 0 < confidence < 1:
        raise ValueError(f"capability: expected a confidence between 0 and 1, found {confidence}")
    n, mean, s = len(x), float(x.mean()), float(x.std(ddof=1))
    if s == 0:
        raise ValueError(f"capability: all {n} values are {mean}: without scatter there is no Cpk")
    tail = (1 - confidence) / 2
    sides = [(mean - lower) / (3 * s)] if lower is not None else []
    sides += [(upper - mean) / (3 * s)] if upper is not None else []
    cpk = min(sides)
    cp = cp_interval = None
    if lower is not None and upper is not None:
        cp = (upper - lower) / (6 * s)
        low, high = (math.sqrt(stats.chi2.ppf(q, n - 1) / (n - 1)) for q in (tail, 1 - tail))
        cp_interval = Interval(cp * low, cp * high)
        z = float(stats.norm.ppf(1 - tail))
        half = z * math.sqrt(1 / (9 * n) + cpk**2 / (2 * (n - 1)))
        cpk_interval = Interval(cpk - half, cpk + half)
    else:
        cpk_interval = _one_sided(cpk, n, tail)
    beyond = (x < (-math.inf if lower is None else lower)) | (x > (math.inf if upper is None else upper))
    out = int(np.count_nonzero(beyond))
    return Capability(
        n, mean, s, lower, upper, cp, cp_interval, cpk, cpk_interval, out, out / n, wilson(out, n, confidence), confidence
    )


def _one_sided(cpk: float, n: int, tail: float) -> Interval:
    """3·√n·Cpk of a sample follows the noncentral t distribution with n − 1 degrees of freedom about 3·√n times the real one."""
    from scipy import optimize, stats

    t = 3 * math.sqrt(n) * cpk

    def real(share: float) -> float:
        spread = 12 * math.sqrt(1 + t * t / (2 * (n - 1)))
        found = optimize.brentq(lambda real: stats.nct.cdf(t, n - 1, real) - share, t - spread, t + spread)
        return float(found) / (3 * math.sqrt(n))

    return Interval(real(1 - tail), real(tail))


def wilson(count: int, n: int, confidence: float = 0.95) -> Interval:
    """Wilson's interval of a share of which ``count`` of ``n`` were seen."""
    from scipy import stats

    if not 0 <= count <= n or n < 1:
        raise ValueError(f"wilson: expected 0 ≤ count ≤ n and n ≥ 1, found {count} of {n}")
    z = float(stats.norm.ppf((1 + confidence) / 2))
    share = count / n
    middle = (share + z * z / (2 * n)) / (1 + z * z / n)
    half = z / (1 + z * z / n) * math.sqrt(share * (1 - share) / n + z * z / (4 * n * n))
    return Interval(max(0.0, middle - half), min(1.0, middle + half))
