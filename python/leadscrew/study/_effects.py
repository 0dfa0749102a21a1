"""Main effects and interactions of factors, by least squares.

Each factor is scaled to −1 … +1 over its range; y = b₀ + Σ bᵢxᵢ + Σ bᵢⱼxᵢxⱼ. The effect of a factor is 2bᵢ: the change of y from
its low to its high end, in the unit of y. Factors that are not numbers are left out.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pyarrow as pa


@dataclass(frozen=True, slots=True)
class Effect:
    """Change of the response from the low to the high end of one factor, or of two together, with its standard error."""

    factors: tuple[str, ...]
    effect: float
    standard_error: float


def effects(table: pa.Table, response: str, factors: Sequence[str] | None = None) -> list[Effect]:
    """Effects on ``response``, the largest first. Interactions are told where there are enough cases for them."""
    import numpy as np
    import pyarrow as pa

    y = np.asarray(table[response].to_pylist(), dtype=float)
    known = np.isfinite(y)
    names, scaled = [], []
    for name in table.column_names if factors is None else factors:
        if not (pa.types.is_integer(table[name].type) or pa.types.is_floating(table[name].type)):
            continue
        x = np.asarray(table[name].to_pylist(), dtype=float)[known]
        if len(x) and np.isfinite(x).all() and x.max() > x.min():
            names.append(name)
            scaled.append((2 * x - x.max() - x.min()) / (x.max() - x.min()))
    y = y[known]
    terms: list[tuple[str, ...]] = [(name,) for name in names]
    columns = list(scaled)
    pairs = list(itertools.combinations(range(len(names)), 2))
    if len(y) > 1 + len(terms) + len(pairs):
        terms += [(names[i], names[j]) for i, j in pairs]
        columns += [scaled[i] * scaled[j] for i, j in pairs]
    if len(y) <= 1 + len(terms) or not terms:
        return []
    matrix = np.column_stack([np.ones(len(y)), *columns])
    found, _, rank, _ = np.linalg.lstsq(matrix, y, rcond=None)
    if rank < matrix.shape[1]:
        return []
    rest = y - matrix @ found
    variance = float(rest @ rest) / (len(y) - matrix.shape[1])
    errors = np.sqrt(variance * np.diag(np.linalg.inv(matrix.T @ matrix)))
    every = [Effect(term, 2 * float(b), 2 * float(e)) for term, b, e in zip(terms, found[1:], errors[1:], strict=True)]
    return sorted(every, key=lambda effect: -abs(effect.effect))
