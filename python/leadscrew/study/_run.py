"""Running a study: cases in batches, each result on the disk as soon as it is there.

::

    cases ─► hash each ─► without those in out/results ─► batches of 50 ms and more ─► executor
                                                                                        │ rows, version
             table, sorted by case ◄── out/results/part-HH/BATCH.parquet ◄── renamed ◄──┘
"""

from __future__ import annotations

import functools
import hashlib
import inspect
import json
import os
import tempfile
import time
from collections import deque
from collections.abc import Callable, Mapping
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, Future, wait
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from .. import _leadscrew as _native
from ._executors import SHORTEST_BATCH_S, Executors, given, threads

if TYPE_CHECKING:
    import pyarrow as pa

Row: TypeAlias = dict[str, Any]
#: A function of a study: a row, or several, for a case.
Function: TypeAlias = Callable[[Mapping[str, Any]], "Row | list[Row]"]

#: Batches that come back in a second, at most: the study's process writes a file for each, and Dask's scheduler hands out as many
#: with ease. Many workers get longer batches.
MOST_BATCHES_PER_S = 100
#: Batches that wait beside those that run, for each worker.
AHEAD = 2
#: An executor is lost so often without a result in between, and the study gives up.
MOST_LOST = 5


class WrongVersion(RuntimeError):
    """A worker has another version of Leadscrew than the study."""


@dataclass(frozen=True, slots=True)
class Progress:
    """How far a study is: cases ``done`` of ``total`` (``found`` of them were there before), and the time left, s."""

    done: int
    total: int
    found: int
    left_s: float | None


def run(
    function: Function,
    cases: pa.Table,
    *,
    out: str | os.PathLike[str],
    executor: Executor | Executors | None = None,
    progress: Callable[[Progress], object] | None = None,
) -> pa.Table:
    """Run ``function`` for each row of ``cases``, and give the table of all results: ``case`` (its number), the factors, and the
    columns of the rows that the function answers with; in the order of the cases, whatever the order in which they ran.

    ``out`` is a folder: ``results/`` is a Parquet dataset that grows while the study runs. The same call again goes on with what
    is missing. ``executor`` is any of ``concurrent.futures``, or :func:`threads` (the default), :func:`processes`, :func:`dask`.

    An exception of the function ends the study, with what is done kept.
    """
    if cases.num_rows == 0:
        raise ValueError("a study needs a case: the table has no rows")
    folder = Path(out)
    results = folder / "results"
    results.mkdir(parents=True, exist_ok=True)
    rows: list[Row] = cases.to_pylist()
    identity = _identity(function)
    hashes = [_hash(identity, row) for row in rows]
    first: dict[str, int] = {}
    for index, name in enumerate(hashes):
        if name in first:
            raise ValueError(f"cases {first[name]} and {index} are the same: give replicates a seed, replicated(cases, 8)")
        first[name] = index
    done = _done(results) & first.keys()
    _keep_about(folder, identity, cases)
    pending = deque(index for index, name in enumerate(hashes) if name not in done)
    executors = executor if isinstance(executor, Executors) else given(executor) if executor else threads()
    told = _Told(progress, len(rows), len(done))
    told()
    try:
        if pending:
            _Running(function, rows, hashes, results, executors, told).all(pending)
    finally:
        executors.close()
    return _table(results, cases, first)


class _Told:
    """Says how far it is."""

    def __init__(self, progress: Callable[[Progress], object] | None, total: int, found: int) -> None:
        self.progress, self.total, self.found = progress, total, found
        self.done, self.began = found, time.monotonic()

    def __call__(self, more: int = 0) -> None:
        self.done += more
        if self.progress is None:
            return
        new = self.done - self.found
        took = time.monotonic() - self.began
        left = took / new * (self.total - self.done) if new else None
        self.progress(Progress(self.done, self.total, self.found, left))


class _Running:
    """A study under way."""

    def __init__(
        self,
        function: Function,
        rows: list[Row],
        hashes: list[str],
        results: Path,
        executors: Executors,
        told: _Told,
    ) -> None:
        self.function, self.rows, self.hashes = function, rows, hashes
        self.results, self.executors, self.told = results, executors, told
        self.seconds, self.measured = 0.0, 0
        self.lost = 0

    def all(self, pending: deque[int]) -> None:
        running: dict[Future[Answer], list[int]] = {}
        executor = self.executors.make()
        try:
            while pending or running:
                is_lost = False
                try:
                    self._fill(executor, pending, running)
                except self._losses() as lost:
                    self._loses(lost)
                    is_lost = True
                done, _ = wait(running, timeout=5, return_when=FIRST_COMPLETED)
                for future in done:
                    batch = running.pop(future)
                    try:
                        answer = future.result()
                    except self._losses() as lost:
                        pending.extendleft(reversed(batch))
                        self._loses(lost)
                        is_lost = True
                        continue
                    self._takes(batch, answer)
                if is_lost:
                    for future, batch in running.items():
                        future.cancel()
                        pending.extendleft(reversed(batch))
                    running.clear()
                    executor.shutdown(wait=False)
                    executor = self.executors.make()
        except BaseException:
            for future in running:
                future.cancel()
            raise
        finally:
            if self.executors.again:
                executor.shutdown(wait=False)

    def _losses(self) -> tuple[type[BaseException], ...]:
        return (BrokenExecutor, CancelledError, *self.executors.lost)

    def _loses(self, why: BaseException) -> None:
        self.lost += 1
        if self.lost > MOST_LOST or not self.executors.again:
            raise RuntimeError(
                f"the workers are lost ({type(why).__name__}: {why}); what is done is kept, and the same call goes on with the rest"
            ) from why

    def _fill(self, executor: Executor, pending: deque[int], running: dict[Future[Answer], list[int]]) -> None:
        # until it is known how long a case takes, no more of them wait than there are workers
        most = self.executors.workers() * (AHEAD if self.measured else 1)
        while pending and len(running) < most:
            batch = [pending.popleft() for _ in range(min(self._batch(len(pending)), len(pending)))]
            try:
                future = executor.submit(work, self.function, [self.rows[i] for i in batch], _native.BUILD)
            except BaseException:
                pending.extendleft(reversed(batch))
                raise
            running[future] = batch

    def _batch(self, left: int) -> int:
        """Cases of the next batch."""
        if not self.measured or self.seconds == 0:
            return 1
        each = self.seconds / self.measured
        return batch_size(each, left, self.executors.workers(), self.executors.shortest_batch_s)

    def _takes(self, batch: list[int], answer: Answer) -> None:
        self.lost = 0
        self.seconds += answer.seconds
        self.measured += len(batch)
        written = [
            {"hash": self.hashes[index], "row": at, **row}
            for index, rows in zip(batch, answer.rows, strict=True)
            for at, row in enumerate(rows)
        ]
        _write(self.results, written)
        self.told(len(batch))


def batch_size(each_s: float, left: int, workers: int, shortest_s: float = SHORTEST_BATCH_S) -> int:
    """Cases of a batch, where a case takes so long and so many of them are left for so many workers."""
    shortest = max(shortest_s, workers / MOST_BATCHES_PER_S)
    wanted = max(1, round(2 * shortest / each_s + 0.5))
    fair = max(1, left // (AHEAD * workers))
    return max(min(wanted, fair), round(shortest / each_s + 0.5))


@dataclass
class Answer:
    """What a worker answers: the rows of each case, and how long it took."""

    rows: list[list[Row]]
    seconds: float


def work(function: Function, cases: list[Row], build: str) -> Answer:
    """What a worker does with a batch."""
    if build != _native.BUILD:
        import socket

        raise WrongVersion(
            f"the worker {socket.gethostname()}, process {os.getpid()}, has leadscrew {_native.BUILD}, the study {build}: "
            "install the same on both"
        )
    began = time.perf_counter()
    rows = []
    for case in cases:
        answer = function(case)
        rows.append(answer if isinstance(answer, list) else [answer])
    return Answer(rows, time.perf_counter() - began)


def _identity(function: Function) -> str:
    """What results depend on beside their case: version and function."""
    fingerprint = _fingerprint(function)
    return hashlib.sha256(f"{_native.BUILD}\n{fingerprint}".encode()).hexdigest()


def _fingerprint(function: Any) -> str:
    if isinstance(function, functools.partial):
        return f"{_fingerprint(function.func)}\n{function.args!r}\n{function.keywords!r}"
    known = getattr(function, "fingerprint", None)
    if known is not None:
        return str(known)
    try:
        return inspect.getsource(function)
    except (OSError, TypeError):
        return str(getattr(function, "__qualname__", type(function).__qualname__))


def _hash(identity: str, row: Row) -> str:
    text = json.dumps(row, sort_keys=True, default=str)
    return hashlib.sha256(f"{identity}\n{text}".encode()).hexdigest()[:32]


def _keep_about(folder: Path, identity: str, cases: pa.Table) -> None:
    import pyarrow.parquet as pq

    about = {"leadscrew": _native.BUILD, "function": identity, "cases": cases.num_rows, "factors": cases.column_names}
    _renamed(folder / "study.json", lambda path: path.write_text(json.dumps(about, indent=2) + "\n", encoding="utf-8"))
    _renamed(folder / "cases.parquet", lambda path: pq.write_table(cases, path))


def _write(results: Path, rows: list[Row]) -> None:
    """One file for each batch, in the part of its first case; whole or not at all."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    name: str = rows[0]["hash"]
    part = results / f"part-{name[:2]}"
    columns = dict.fromkeys(key for row in rows for key in row)
    table = pa.table({key: [row.get(key) for row in rows] for key in columns})
    _renamed(part / f"{name}.parquet", lambda path: pq.write_table(table, path))


def _renamed(path: Path, write: Callable[[Path], object]) -> None:
    made: Path | None = None
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=".", suffix=".part", dir=path.parent)
        os.close(handle)
        made = Path(name)
        write(made)
        made.replace(path)
    except OSError as error:
        if made is not None:
            made.unlink(missing_ok=True)
        raise OSError(
            error.errno or 0,
            f"the study stops: {path} cannot be written ({error}); what is done is kept, and the same call goes on with the rest",
        ) from error


def _files(results: Path) -> list[Path]:
    return sorted(results.glob("part-*/*.parquet"))


def _done(results: Path) -> set[str]:
    import pyarrow.parquet as pq

    done: set[str] = set()
    for path in _files(results):
        done.update(pq.read_table(path, columns=["hash"], partitioning=None)["hash"].to_pylist())
    return done


def _table(results: Path, cases: pa.Table, first: Mapping[str, int]) -> pa.Table:
    """All results of these cases, sorted."""
    import pyarrow as pa
    import pyarrow.compute as pc
    import pyarrow.parquet as pq

    parts = [pq.read_table(path, partitioning=None) for path in _files(results)]
    whole = pa.concat_tables(parts, promote_options="permissive")
    numbers = pa.array([first.get(name) for name in whole["hash"].to_pylist()], pa.int64())
    whole = whole.append_column("case", numbers).filter(pc.is_valid(numbers))
    order = pc.sort_indices(whole, sort_keys=[("case", "ascending"), ("row", "ascending")])
    whole = whole.take(order)
    factors = cases.take(whole["case"])
    columns = {"case": whole["case"], **{name: factors[name] for name in factors.column_names}}
    measured = sorted(set(whole.column_names) - {"case", "hash", "row"} - set(columns))
    columns.update({name: whole[name] for name in measured})
    columns["hash"] = whole["hash"]
    return pa.table(columns).combine_chunks()
