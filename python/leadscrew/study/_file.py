"""A study in a file: what ``leadscrew study FILE.toml`` reads.

Every key is checked, and one that there is not gets its nearest neighbour named.
"""

from __future__ import annotations

import difflib
import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .._errors import Refused
from .._machine import MACHINES, Machine
from ._cases import full_factorial, latin_hypercube, replicated, sobol
from ._cut import Cut
from ._executors import Executors, dask, processes, threads

if TYPE_CHECKING:
    import pyarrow as pa

DESIGNS = ("latin-hypercube", "sobol", "full-factorial")
KINDS = ("threads", "processes", "dask")


@dataclass(frozen=True, slots=True)
class Characteristic:
    """What is looked at: a column of the features of one kind, and its limits."""

    name: str
    of: str | None
    lower: float | None
    upper: float | None


@dataclass(frozen=True, slots=True)
class StudyFile:
    """A study, read and checked."""

    title: str
    cut: Cut
    cases: pa.Table
    factors: tuple[str, ...]
    characteristics: tuple[Characteristic, ...]
    executors: Executors
    out: Path


def read(path: str | Path, *, out: str | None = None, scheduler: str | None = None, workers: int | None = None) -> StudyFile:
    """Read a study's file; what the command line says counts before what it says."""
    path = Path(path)
    try:
        document = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise Refused(f"cannot read {path}: {error.strerror}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise Refused(f"{path} is not TOML: {error}") from None
    at = _Table(f"{path}", document)
    head = at.table("study")
    program = head.path("program", path.parent)
    machine = _machine(head.text("machine", "tapping-center"), path.parent)
    plant = head.text("plant", "")
    design = head.choice("design", DESIGNS)
    count = head.whole("cases", 128)
    seed = head.whole("seed", 1)
    replicates = head.whole("replicates", 1)
    title = head.text("title", path.stem)
    folder = Path(out) if out is not None else path.parent / head.text("out", f"{path.stem}-study")
    head.end()
    options = at.table("options", {}).rest()
    factors = at.table("factors").rest()
    if not factors:
        raise Refused(f"{path}: [factors] is empty: expected what varies, as in \"plant.axes.z.structure.backlash_um\" = {{ from = 1, to = 15 }}")
    characteristics = tuple(_characteristic(each) for each in at.tables("characteristics"))
    run = at.table("executor", {})
    kind = "dask" if scheduler is not None else run.choice("kind", KINDS)
    scheduler = scheduler or run.text("scheduler", "") or None
    workers = workers or run.whole("workers", 0) or None
    run.end()
    at.end()
    if not program.is_file():
        raise Refused(f"{path}: there is no program {program}")
    cut = Cut(
        program, machine=machine, plant=_machine(plant, path.parent) if plant else None, options=options  # type: ignore[arg-type]
    )
    try:
        cases = _cases(factors, design, count, seed)
        cases = cases if "seed" in cases.column_names else replicated(cases, replicates)
    except ValueError as error:
        raise Refused(f"{path}: {error}") from None
    for row in cases.slice(0, 1).to_pylist():
        cut.arguments(row)  # a factor that is none is refused before anything runs
    executors = {"threads": threads, "processes": processes}.get(kind, threads)(workers) if kind != "dask" else dask(scheduler, workers=workers)
    usual = (Characteristic("margin_um", "thread", 0.0, None),)
    return StudyFile(title, cut, cases, tuple(factors), characteristics or usual, executors, folder)


def _machine(name: str, beside: Path) -> Machine:
    return Machine.load(name if name in MACHINES or not (beside / name).exists() else beside / name)


def _cases(factors: Mapping[str, Any], design: str, count: int, seed: int) -> pa.Table:
    """Ranges by the design, crossed with every combination of the levels."""
    import pyarrow as pa

    levels: dict[str, Sequence[Any]] = {}
    ranges: dict[str, Any] = {}
    for name, said in factors.items():
        if isinstance(said, list):
            levels[name] = said
        elif isinstance(said, dict) and set(said) == {"from", "to"}:
            ranges[name] = (float(said["from"]), float(said["to"]))
        elif isinstance(said, dict) and set(said) == {"mean", "deviation"}:
            from scipy import stats

            ranges[name] = stats.norm(float(said["mean"]), float(said["deviation"]))
        else:
            raise ValueError(f"factor {name}: expected a list of levels, {{ from, to }} or {{ mean, deviation }}")
    if ranges and design == "full-factorial":
        raise ValueError(f"factor {next(iter(ranges))}: a full factorial needs a list of levels; design = \"latin-hypercube\" takes ranges")
    drawn = None
    if ranges:
        drawn = (sobol if design == "sobol" else latin_hypercube)(ranges, n=count, seed=seed)
    if not levels:
        assert drawn is not None
        return drawn
    crossed = full_factorial(levels)
    if drawn is None:
        return crossed
    if math.prod((drawn.num_rows, crossed.num_rows)) > 10_000_000:
        raise ValueError(f"{drawn.num_rows * crossed.num_rows:,} cases: expected 10,000,000 at most")
    left = drawn.take(pa.array([row for row in range(drawn.num_rows) for _ in range(crossed.num_rows)]))
    right = crossed.take(pa.array(list(range(crossed.num_rows)) * drawn.num_rows))
    return pa.table({**{n: left[n] for n in left.column_names}, **{n: right[n] for n in right.column_names}})


def _characteristic(table: _Table) -> Characteristic:
    name, of = table.text("name"), table.text("of", "") or None
    lower, upper = table.number("lower"), table.number("upper")
    table.end()
    if lower is None and upper is None:
        raise Refused(f"{table.name}: {name} needs lower or upper")
    return Characteristic(name, of, lower, upper)


class _Table:
    """A table of the file, and which of its keys were asked for."""

    def __init__(self, name: str, values: Mapping[str, Any]) -> None:
        self.name, self.values = name, dict(values)
        self.asked: list[str] = []

    def _get(self, key: str, kind: type | tuple[type, ...], expected: str, default: Any) -> Any:
        self.asked.append(key)
        if key not in self.values:
            if default is ...:
                raise Refused(f"{self.name} lacks the key {key}: expected {expected}")
            return default
        value = self.values[key]
        if not isinstance(value, kind) or isinstance(value, bool):
            raise Refused(f"{self.name}: {key} is {value!r}: expected {expected}")
        return value

    def text(self, key: str, default: Any = ...) -> str:
        value: str = self._get(key, str, "text in quotes", default)
        return value

    def path(self, key: str, beside: Path) -> Path:
        return beside / self.text(key)

    def whole(self, key: str, default: int) -> int:
        value: int = self._get(key, int, "a whole number", default)
        if value < 0:
            raise Refused(f"{self.name}: {key} is {value}: expected a whole number from 0")
        return value

    def number(self, key: str) -> float | None:
        value = self._get(key, (int, float), "a number", None)
        return None if value is None else float(value)

    def choice(self, key: str, names: Sequence[str]) -> str:
        value = self.text(key, names[0])
        if value not in names:
            raise Refused(f"{self.name}: {key} is \"{value}\": expected {' or '.join(names)}")
        return value

    def table(self, key: str, default: Any = ...) -> _Table:
        return _Table(f"{self.name} [{key}]", self._get(key, dict, "a table", default))

    def tables(self, key: str) -> list[_Table]:
        values = self._get(key, list, f"tables headed [[{key}]]", [])
        return [_Table(f"{self.name} [[{key}]]", value) for value in values]

    def rest(self) -> dict[str, Any]:
        return self.values

    def end(self) -> None:
        for key in self.values:
            if key not in self.asked:
                near = difflib.get_close_matches(key, self.asked, 1)
                hint = f": did you mean {near[0]}?" if near else f": expected {', '.join(self.asked)}"
                raise Refused(f"{self.name} has an unknown key {key}{hint}")
