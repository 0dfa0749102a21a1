"""Where cases are executed: each of these makes an executor, and another one when that is lost."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import dataclass, field
from multiprocessing import get_context
from typing import Any


#: A batch takes at least so long, s: what is handed about costs about a millisecond.
SHORTEST_BATCH_S = 0.05


@dataclass
class Executors:
    """How executors are made."""

    make: Callable[[], Executor]
    """A new one."""
    workers: Callable[[], int]
    """How many cases it executes at a time, by now."""
    close: Callable[[], None] = lambda: None
    """What is left to be done when the study is over."""
    about: Callable[[], str] = lambda: ""
    """What a person wants to know of it, such as the address of a dashboard."""
    again: bool = True
    """A lost one is followed by another."""
    shortest_batch_s: float = SHORTEST_BATCH_S
    """Batches of cases are no shorter: handing one out has its price."""
    lost: tuple[type[BaseException], ...] = field(default=())
    """Exceptions that say that a worker was lost, and not that a case has failed."""


def processors() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def threads(workers: int | None = None) -> Executors:
    """Threads of this process, one for each processor: Python's lock is released while a case is simulated."""
    count = workers or processors()
    return Executors(lambda: ThreadPoolExecutor(count, "study"), lambda: count)


def processes(workers: int | None = None) -> Executors:
    """Processes on this machine, one for each processor. One that is killed costs its running cases, which run again."""
    count = workers or processors()
    return Executors(lambda: ProcessPoolExecutor(count, get_context("spawn")), lambda: count)


def dask(scheduler: str | None = None, *, workers: int | None = None, retries: int = 3, patience_s: float = 120) -> Executors:
    """A Dask cluster: the scheduler's address, or a cluster on this machine (one process of one thread for each processor) that
    is made and closed. A worker that is killed loses its running cases, which Dask gives to another one up to ``retries``
    times; a scheduler that is restarted at the same address within ``patience_s`` is found again."""
    from distributed import Client, LocalCluster
    from distributed.comm.core import CommClosedError
    from distributed.scheduler import KilledWorker

    held: dict[str, Any] = {"cluster": None, "client": None}
    counted: tuple[float, int] = (0.0, 0)

    def client() -> Any:
        if held["client"] is not None and held["client"].status in ("running", "connecting"):
            return held["client"]
        if held["client"] is not None:
            held["client"].close(timeout=5)
        address = scheduler
        if address is None:
            if held["cluster"] is None:
                held["cluster"] = LocalCluster(  # type: ignore[no-untyped-call]
                    n_workers=workers or processors(), threads_per_worker=1, dashboard_address=":0"
                )
            address = held["cluster"].scheduler_address
        held["client"] = Client(address, timeout=patience_s, set_as_default=False)  # type: ignore[no-untyped-call]
        return held["client"]

    def make() -> Executor:
        executor: Executor = client().get_executor(pure=False, retries=retries)
        return executor

    def count() -> int:
        # the scheduler is asked, which is not for nothing
        nonlocal counted
        if counted[1] == 0 or time.monotonic() - counted[0] > 1:
            counts: dict[str, int] = client().nthreads()
            counted = (time.monotonic(), max(1, sum(counts.values())))
        return counted[1]

    def close() -> None:
        for name in ("client", "cluster"):
            if held[name] is not None:
                held[name].close()
                held[name] = None

    def about() -> str:
        return f"Dask's dashboard: {client().dashboard_link}"

    return Executors(make, count, close, about, shortest_batch_s=0.25, lost=(KilledWorker, CommClosedError))


def given(executor: Executor) -> Executors:
    """One that the caller has made, and closes."""
    count: int = getattr(executor, "_max_workers", 0) or processors()
    return Executors(lambda: executor, lambda: count, again=False)
