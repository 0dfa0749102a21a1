"""Tables of cases: a column for each factor, a row for each case."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

if TYPE_CHECKING:
    import numpy as np
    import pyarrow as pa

#: Most cases of a table: a hundred days of one worker that takes a second for each.
MOST_CASES = 10_000_000


class Distribution(Protocol):
    """What a factor is drawn from, such as ``scipy.stats.norm(5, 1)``."""

    def ppf(self, q: Any) -> Any:
        """The value below which a share ``q`` lies."""


Range: TypeAlias = "tuple[float, float] | Distribution"


def full_factorial(levels: Mapping[str, Sequence[Any]]) -> pa.Table:
    """Every combination of the levels; the last factor varies fastest."""
    import pyarrow as pa

    if not levels:
        raise ValueError("a study needs a factor: expected {name: levels}")
    for name, values in levels.items():
        if isinstance(values, str) or len(values) == 0:
            raise ValueError(f"{name}: expected a list of levels")
    _bounded(math.prod(len(values) for values in levels.values()), "a full factorial")
    rows = list(itertools.product(*levels.values()))
    return pa.table({name: [row[at] for row in rows] for at, name in enumerate(levels)})


def latin_hypercube(ranges: Mapping[str, Range], *, n: int, seed: int) -> pa.Table:
    """``n`` cases, of which each of ``n`` equally likely stretches of each factor has one. A range is ``(low, high)``, or a
    distribution of ``scipy.stats``."""
    from scipy.stats import qmc

    _bounded(n, "a Latin hypercube")
    return _drawn(ranges, qmc.LatinHypercube(len(ranges), rng=seed).random(n))


def sobol(ranges: Mapping[str, Range], *, n: int, seed: int) -> pa.Table:
    """``n`` cases (a power of two) of a scrambled Sobol sequence: even in each factor and in pairs of them."""
    from scipy.stats import qmc

    _bounded(n, "a Sobol sequence")
    if n & (n - 1):
        lower = 1 << (n.bit_length() - 1)
        raise ValueError(f"a Sobol sequence of {n}: expected a power of two, such as {lower} or {2 * lower}")
    return _drawn(ranges, qmc.Sobol(len(ranges), rng=seed).random(n))


def replicated(cases: pa.Table, seeds: int | Iterable[int]) -> pa.Table:
    """Each case once with each seed (``8`` is 1 to 8): the column ``seed``, which varies fastest."""
    import pyarrow as pa

    values = list(range(1, seeds + 1)) if isinstance(seeds, int) else list(seeds)
    if not values:
        raise ValueError("expected at least one seed")
    _bounded(cases.num_rows * len(values), "a replicated table")
    rows = [row for row in range(cases.num_rows) for _ in values]
    return cases.take(pa.array(rows, pa.int64())).append_column("seed", pa.array(values * cases.num_rows, pa.int64()))


def _bounded(count: int, what: str) -> None:
    if count > MOST_CASES:
        raise ValueError(
            f"{what} of {count:,} cases: expected {MOST_CASES:,} at most; latin_hypercube(…, n=1000, seed=1) covers the same ranges"
        )
    if count < 1:
        raise ValueError(f"{what} of {count} cases: expected at least 1")


def _drawn(ranges: Mapping[str, Range], unit: np.ndarray) -> pa.Table:
    import pyarrow as pa

    if not ranges:
        raise ValueError("a study needs a factor: expected {name: (low, high)}")
    columns = {}
    for at, (name, of) in enumerate(ranges.items()):
        if isinstance(of, tuple):
            low, high = of
            if not low < high:
                raise ValueError(f"{name}: expected (low, high) with low < high, found ({low}, {high})")
            columns[name] = low + (high - low) * unit[:, at]
        else:
            columns[name] = of.ppf(unit[:, at])
    return pa.table(columns)
