"""``leadscrew study FILE.toml``."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence

from .._errors import Refused
from ._run import Progress, WrongVersion, run

_EPILOG = """Exit code: 0 every characteristic is within its limits in every case; 1 one is not, or is not judged; 2 the study was
refused or stopped, with what is done kept: the same command goes on.

Examples:
  leadscrew study plate.toml
  leadscrew study plate.toml --scheduler tcp://10.0.0.5:8786     on a Dask cluster"""


def main(words: Sequence[str]) -> int:
    """Do it; the exit code."""
    parser = argparse.ArgumentParser(
        "leadscrew study",
        description="Run a program over many cases and say how capable the process is.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", help="the study: TOML")
    parser.add_argument("--out", help="folder of results and report [default: as the file says]")
    parser.add_argument("--scheduler", help="address of a Dask scheduler")
    parser.add_argument("--workers", type=int, help="cases at a time [default: a processor each]")
    parser.add_argument("-q", "--quiet", action="store_true", help="no progress")
    asked = parser.parse_args(words)
    try:
        return _study(asked)
    except (Refused, WrongVersion, OSError, RuntimeError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except ModuleNotFoundError as error:
        print(f"error: {error}: pip install 'leadscrew[dask]' brings what studies need", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("\ninterrupted: what is done is kept, and the same command goes on with the rest", file=sys.stderr)
        return 130


def _study(asked: argparse.Namespace) -> int:
    import pyarrow.parquet as pq

    from . import _report
    from ._file import read

    study = read(asked.file, out=asked.out, scheduler=asked.scheduler, workers=asked.workers)
    if not asked.quiet and (about := study.executors.about()):
        print(about, file=sys.stderr)
    table = run(study.cut, study.cases, out=study.out, executor=study.executors, progress=None if asked.quiet else _Bar())
    pq.write_table(table, study.out / "table.parquet")
    judged = _report.judge(study, table)
    (study.out / "report.html").write_text(_report.page(study, table, judged, study.out), encoding="utf-8")
    print(_report.text(study, table, judged, study.out), end="")
    print(f"\nreport: {study.out / 'report.html'}; table: {study.out / 'table.parquet'}")
    good = all(each.capability is not None and each.capability.out == 0 for each in judged)
    return 0 if good and set(table["ending"].to_pylist()) <= {"good"} else 1


class _Bar:
    """Progress on a terminal: one line; else a line every tenth."""

    def __init__(self) -> None:
        self.is_terminal = sys.stderr.isatty()
        self.last = -1
        self.said = 0.0

    def __call__(self, progress: Progress) -> None:
        tenth = 10 * progress.done // max(1, progress.total)
        now = time.monotonic()
        is_due = now - self.said > 0.2 or progress.done == progress.total if self.is_terminal else tenth > self.last
        if not is_due:
            return
        self.last, self.said = tenth, now
        left = "" if progress.left_s is None else f", {_duration(progress.left_s)} left"
        line = f"{progress.done} of {progress.total} cases{left}"
        end = "\n" if not self.is_terminal or progress.done == progress.total else ""
        print(f"\r{line:<50}" if self.is_terminal else line, end=end, file=sys.stderr, flush=True)


def _duration(seconds: float) -> str:
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
