#!/usr/bin/env python3
"""Measures what a run costs when Python calls it, beside the command `leadscrew run`, in alternation; prints the medians.

    python tools/call-overhead.py target/release/leadscrew programs/plate-12xM6.ngc --rounds 15

Both take processor time, user and system, which other work on the machine changes little. The command's has the start of a
process in it, Python's has not. A round runs each of them twice, the second time the other way round.
"""

from __future__ import annotations

import argparse
import os
import resource
import statistics
import subprocess
import time

import leadscrew


def of_command(words: list[str]) -> float:
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def of_call(program: str, machine: str) -> float:
    before = time.process_time()
    result = leadscrew.run(program, machine=machine, seed=1)
    spent = time.process_time() - before
    assert result.passed
    return spent


def main() -> None:
    asked = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    asked.add_argument("command", help="the command, built in release")
    asked.add_argument("program")
    asked.add_argument("--machine", default="tapping-center")
    asked.add_argument("--rounds", type=int, default=15)
    args = asked.parse_args()
    words = [os.path.abspath(args.command), "run", args.program, "--machine", args.machine, "--seed", "1", "-q"]
    command, call, ratios = [], [], []
    for _ in range(args.rounds):
        first, second = of_command(words), of_call(args.program, args.machine)
        third, fourth = of_call(args.program, args.machine), of_command(words)
        command.append((first + fourth) / 2)
        call.append((second + third) / 2)
        ratios.append(call[-1] / command[-1])
    print(f"command {statistics.median(command) * 1e3:7.1f} ms of processor time")
    print(f"Python  {statistics.median(call) * 1e3:7.1f} ms")
    low, _, high = statistics.quantiles(ratios, n=4)
    print(f"Python over command: {statistics.median(ratios):.4f}, middle half of the rounds {low:.4f} to {high:.4f}")

    result = leadscrew.run(args.program, machine=args.machine, seed=1, trace=True)
    trace = result.trace
    assert trace is not None
    trace.to_pandas()
    took = []
    for _ in range(args.rounds):
        began = time.perf_counter()
        frame = trace.to_pandas()
        took.append(time.perf_counter() - began)
    print(f"trace to pandas: {len(frame):,} rows of {len(frame.columns)} columns in {statistics.median(took) * 1e3:.1f} ms")


if __name__ == "__main__":
    main()
