#!/usr/bin/env python3
"""Measures how a study scales over workers: threads, processes and Dask, in alternation; prints the medians.

    python tools/study-scaling.py --cases 200 --rounds 3

Beside the time by the clock it takes the processor time of all processes together, which other work on the machine changes
little: efficiency of n workers is the processor time of a case with one worker over that with n.
"""

from __future__ import annotations

import argparse
import multiprocessing
import resource
import statistics
import tempfile
import time
from collections import defaultdict

from leadscrew import study

TAP = """G21 G90 G54 G17 G94
T3 M6
G43 H3
S2000 M3
G0 X0 Y0 Z5
G99 G84 X0 Y0 Z-12 R5 F2000
G80
M2
"""
PLAY = "plant.axes.z.structure.backlash_um"


def processor_s() -> float:
    """Of this process and of those that it has started, once they have ended."""
    for process in multiprocessing.active_children():
        process.join(30)
    both = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(used.ru_utime + used.ru_stime for used in both)


def main() -> None:
    asked = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    asked.add_argument("--cases", type=int, default=200)
    asked.add_argument("--rounds", type=int, default=3)
    asked.add_argument("--only", choices=["processes-1", "processes-2", "threads-2", "dask-2"], action="append")
    args = asked.parse_args()
    cut = study.Cut("tap.ngc", text=TAP)
    cases = study.latin_hypercube({PLAY: (1, 15)}, n=args.cases, seed=1)
    kinds = {
        "processes-1": lambda: study.processes(1),
        "processes-2": lambda: study.processes(2),
        "threads-2": lambda: study.threads(2),
        "dask-2": lambda: study.dask(workers=2),
    }
    kinds = {name: make for name, make in kinds.items() if not args.only or name in args.only}
    found: dict[str, list[tuple[float, float]]] = defaultdict(list)
    whole = None
    for _ in range(args.rounds):
        for name, make in kinds.items():
            with tempfile.TemporaryDirectory() as out:
                clock, processor = time.perf_counter(), processor_s()
                table = study.run(cut, cases, out=out, executor=make())
                took = (time.perf_counter() - clock) / args.cases, (processor_s() - processor) / args.cases
            found[name].append(took)
            whole = whole or table
            assert table.equals(whole), f"{name}: another table"
    for name, took in found.items():
        clock, processor = (statistics.median(column) for column in zip(*took, strict=True))
        print(f"{name:12} {1 / clock:6.1f} cases/s by the clock, {processor * 1e3:6.1f} ms of processor time a case")
    most = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    print(f"largest worker {most:.0f} MiB; the tables are the same to the bit")


if __name__ == "__main__":
    main()
