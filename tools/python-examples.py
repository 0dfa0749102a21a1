#!/usr/bin/env python3
"""Runs the examples of a page, as they stand and in their order: python tools/python-examples.py PAGE SECTION...

Examples of one page share their names, as in one session. They run in a new folder with the programs of this repository and
`part.ngc`, a program with one thread.
"""

from __future__ import annotations

import os
import re
import shutil
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PART = """G21 G90 G94 G17 G54
T2 M6
S3000 M3
G43 H2 G0 Z10
G81 X10 Y10 Z-16 R2 F450
G80 G0 Z20
T3 M6
S1000 M3
G43 H3 G0 X10 Y10 Z10
G84 X10 Y10 Z-12 R5 F1000
G80 G0 Z20
M30
"""


def examples(page: str, sections: list[str]) -> list[tuple[str, str]]:
    """Python blocks of these sections, with the name of each."""
    found = []
    section = ""
    for piece in re.split(r"^## ", page, flags=re.MULTILINE):
        section = piece.splitlines()[0]
        if section in sections:
            found += [(section, block) for block in re.findall(r"```python\n(.*?)```", piece, re.DOTALL)]
    return found


def main() -> int:
    page, sections = Path(sys.argv[1]).resolve(), sys.argv[2:]
    blocks = examples(page.read_text(encoding="utf-8"), sections)
    if {name for name, _ in blocks} != set(sections):
        raise SystemExit(f"{page.name} has no example in one of {sections}")
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        shutil.copytree(ROOT / "programs", "programs")
        Path("part.ngc").write_text(PART, encoding="utf-8")
        names: dict[str, object] = {"__name__": "example"}
        for name, block in blocks:
            exec(compile(block, f"{page.name}, {name}", "exec"), names)  # noqa: S102: the page is ours
        os.chdir(ROOT)
    print(f"{page.name}: {len(blocks)} examples of {', '.join(sections)} run as they stand")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
