"""What came of a run."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from . import _leadscrew as _native
from ._errors import Diagnostic

if TYPE_CHECKING:
    import pyarrow as pa


@dataclass(frozen=True, slots=True)
class Event:
    """Something that has happened: ``time_s`` since the machine was started, s; program ``line``, 0 for none."""

    time_s: float
    line: int
    kind: str
    text: str


class Result:
    """What came of a run: verdict, features with their measures, events, trace, report."""

    def __init__(self, native: _native.RunResult) -> None:
        self._native = native

    @property
    def passed(self) -> bool:
        """The program ended, and every feature is within tolerance: what the command's exit code 0 says."""
        return self.ending == "good"

    @cached_property
    def ending(self) -> Literal["good", "out-of-tolerance", "alarm"]:
        """How the run ended. An alarm is a result, not an exception: ``certificate["alarms"]`` has its number."""
        return self._native.ending

    @cached_property
    def certificate(self) -> dict[str, Any]:
        """What ``certificate.json`` has: every key with its unit."""
        value: dict[str, Any] = json.loads(self._native.certificate())
        return value

    @cached_property
    def cycle_time_s(self) -> float:
        """How long the machine took, s."""
        return float(self.certificate["cycle_time_s"])

    @cached_property
    def features(self) -> pa.Table:
        """What was cut, a row each in the order cut: ``kind``, ``line``, ``verdict``, ``reason``, and the measures of its
        kind by their names in the certificate, with the unit in the name and in the field's metadata (``b"unit"``).
        What was not measured, or is of another kind, is null."""
        return features_table(self.certificate["features"])

    @cached_property
    def trace(self) -> pa.Table:
        """Every servo period, a row each, with the columns of ``trace.parquet``; units in each field's metadata
        (``b"unit"``), program, machine and seed in the schema's. The numbers are not copied.

        ``ValueError`` where the run was not asked to record it: ``run(…, trace=True)``.
        """
        import pyarrow as pa

        if self._native.trace is None:
            raise ValueError("this run has recorded no trace: run(…, trace=True) does")
        return pa.table(self._native.trace)

    @cached_property
    def events(self) -> tuple[Event, ...]:
        """What happened, in its order."""
        return tuple(Event(*event) for event in self._native.events())

    @cached_property
    def findings(self) -> tuple[Diagnostic, ...]:
        """What is known of the program from before anything moved: warnings and notes."""
        return tuple(Diagnostic._of(found) for found in json.loads(self._native.findings()))

    @cached_property
    def notes(self) -> tuple[str, ...]:
        """What stopped the run from outside and what became of that; faults that were ordered and have not come."""
        return tuple(self._native.notes())

    def report(self, path: str | os.PathLike[str] | None = None) -> str:
        """The report, a page of HTML in one file; written to ``path`` if one is named."""
        page = self._native.report()
        if path is not None:
            Path(path).write_text(page, encoding="utf-8")
        return page

    def __repr__(self) -> str:
        return f"Result({self.ending!r}, {len(self.certificate['features'])} features)"


def features_table(features: list[dict[str, Any]]) -> pa.Table:
    """Features of a certificate as a table: what is nested gets a name of both, such as ``contact_reach_mm``."""
    import pyarrow as pa

    rows = [_flat(feature) for feature in features]
    names = list(dict.fromkeys(name for row in rows for name in row))
    columns, fields = [], []
    for name in names:
        values = [row.get(name) for row in rows]
        unit = _native.unit_of(name)
        kind = pa.float64() if unit else None
        if unit and any(isinstance(value, list) for value in values):
            kind = None
        if kind is None and all(value is None for value in values):
            kind = pa.string()
        column = pa.array(values, kind)
        columns.append(column)
        fields.append(pa.field(name, column.type, metadata={"unit": unit} if unit else None))
    return pa.Table.from_arrays(columns, schema=pa.schema(fields))


def _flat(feature: dict[str, Any], under: str = "") -> dict[str, Any]:
    row: dict[str, Any] = {}
    for key, value in feature.items():
        if isinstance(value, dict):
            row.update(_flat(value, f"{under}{key}_"))
        else:
            row[under + key] = value
    return row
