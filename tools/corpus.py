#!/usr/bin/env python3
"""Real programs from public repositories: fetched by repository, commit and path, held against their checksum, and checked.

    python tools/corpus.py fetch FOLDER              from the hosting site, what is not there yet
    python tools/corpus.py verdicts FOLDER --half open    `leadscrew check --summary` on one part: `open`, `kept`, `blind` or `second`
    python tools/corpus.py verdicts FOLDER --write   on all, and docs/corpus/verdicts.tsv anew
    python tools/corpus.py motion FOLDER             what both accept, call by call against LinuxCNC's stand-alone interpreter

The programs are not part of this repository: they are their authors'. docs/corpus/list.tsv says where each is.
"""

from __future__ import annotations

import argparse
import collections
import csv
import hashlib
import json
import subprocess
import sys
import urllib.parse
import urllib.request
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LIST = ROOT / "docs/corpus/list.tsv"
VERDICTS = ROOT / "docs/corpus/verdicts.tsv"
REFUSED = ROOT / "docs/corpus/refused.tsv"
#: Classes of refused.tsv that are no whole program for a machine tool of these controls.
NO_PROGRAM = ("printer", "other control", "no program", "subprogram", "incomplete")
#: Programs that are given to the command at once.
AT_ONCE = 40
#: Larger programs are not compared: each takes seconds.
MOST_BYTES = 2_000_000


def listed(half: str) -> list[dict[str, str]]:
    with LIST.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file, delimiter="\t"))
    return [row for row in rows if half in ("all", row["half"])]


def place(folder: Path, row: dict[str, str]) -> Path:
    return folder / row["repository"].replace("/", "+") / row["path"]


def is_whole(path: Path, row: dict[str, str]) -> bool:
    return path.is_file() and hashlib.sha256(path.read_bytes()).hexdigest() == row["sha256"]


def fetch(folder: Path) -> int:
    missing = 0
    for row in listed("all"):
        path = place(folder, row)
        if is_whole(path, row):
            continue
        address = f"https://raw.githubusercontent.com/{row['repository']}/{row['commit']}/{urllib.parse.quote(row['path'])}"
        try:
            with urllib.request.urlopen(address, timeout=60) as answer:
                data = answer.read()
        except OSError as error:
            print(f"{row['repository']} {row['path']}: {error}", file=sys.stderr)
            missing += 1
            continue
        if hashlib.sha256(data).hexdigest() != row["sha256"]:
            print(f"{row['repository']} {row['path']}: other bytes than listed", file=sys.stderr)
            missing += 1
            continue
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    print(f"{missing} programs are missing")
    return 1 if missing else 0


def verdicts(folder: Path, half: str, command: str, write: bool) -> int:
    rows = {str(place(folder, row)): row for row in listed(half) if is_whole(place(folder, row), row)}
    asked = list(rows)
    found: list[dict[str, object]] = []
    for first in range(0, len(asked), AT_ONCE):
        some = asked[first : first + AT_ONCE]
        words = [command, "check", "--summary", "--format", "json", "--accept", "unknown-m-codes", *some]
        done = subprocess.run(words, capture_output=True, text=True, check=False)
        if done.returncode not in (0, 2):
            raise SystemExit(f"{command} ended with {done.returncode}: {done.stderr}")
        found += json.loads(done.stdout)["programs"]
    total: collections.Counter[str] = collections.Counter()
    good: collections.Counter[str] = collections.Counter()
    lines = ["repository\tpath\tdialect\tmachine\terrors\tfirst"]
    for program in found:
        row = rows[str(program["program"])]
        total[row["kind"]] += 1
        good[row["kind"]] += program["errors"] == 0
        why = program["first"]
        said = f"line {why['line']}: {why['code']} {why['message']}" if isinstance(why, dict) else ""
        cells = [row["repository"], row["path"], program["dialect"], program["machine"], program["errors"], said]
        lines.append("\t".join(str(cell).replace("\t", " ").replace("\n", " ") for cell in cells))
    if write:
        VERDICTS.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(f"{'kind':18}{'can be executed':>16}{'of':>6}")
    for kind in sorted(total):
        print(f"{kind:18}{good[kind]:16}{total[kind]:6}")
    print(f"{'all':18}{sum(good.values()):16}{sum(total.values()):6}")
    shares(rows, found, sum(good.values()))
    return 0


def shares(rows: dict[str, dict[str, str]], found: list[dict[str, object]], good: int) -> None:
    """Of all, and of those that are whole programs for such a machine: refused.tsv says which are not, and why, read by hand."""
    with REFUSED.open(encoding="utf-8", newline="") as file:
        table = csv.DictReader(file, delimiter="\t", quoting=csv.QUOTE_NONE)
        classes = {(row["repository"], row["path"]): row["class"] for row in table}
    refused = [rows[str(program["program"])] for program in found if program["errors"] != 0]
    counts = collections.Counter(classes.get((row["repository"], row["path"]), "not read yet") for row in refused)
    for kind, count in counts.most_common():
        print(f"refused, {kind:18}{count:6}")
    whole = len(found) - sum(counts[kind] for kind in NO_PROGRAM)
    print(f"of all {good / len(found):.1%}, of whole programs for such machines {good / whole:.1%} ({good} of {whole})")
    taken = whole - counts["program"]
    print(f"of those that their own control takes {good / taken:.1%} ({good} of {taken})")


def motion(folder: Path, half: str) -> int:
    """Equal or different, with the first difference: `cargo xtask parity --live` on the programs of mills and lathes."""
    kinds = ("grbl-mill", "linuxcnc-mill", "linuxcnc-lathe")
    rows = [row for row in listed(half) if row["kind"] in kinds and int(row["bytes"]) < MOST_BYTES]
    files = [str(place(folder, row).resolve()) for row in rows if is_whole(place(folder, row), row)]
    return subprocess.run(["cargo", "xtask", "parity", "--live", *files], cwd=ROOT, check=False).returncode


def main() -> int:
    asked = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    asked.add_argument("what", choices=["fetch", "verdicts", "motion"])
    asked.add_argument("folder", type=Path)
    asked.add_argument("--half", choices=["open", "kept", "blind", "second", "all"], default="all")
    asked.add_argument("--command", default=str(ROOT / "target/debug/leadscrew"), help="the command that checks")
    asked.add_argument("--write", action="store_true", help="write docs/corpus/verdicts.tsv anew")
    args = asked.parse_args()
    if args.what == "fetch":
        return fetch(args.folder)
    if args.what == "motion":
        return motion(args.folder, args.half)
    return verdicts(args.folder, args.half, args.command, args.write)


if __name__ == "__main__":
    raise SystemExit(main())
