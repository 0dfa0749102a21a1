"""What the tests share."""

from __future__ import annotations

from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PLATE = ROOT / "programs" / "plate-12xM6.ngc"

#: A hole, drilled and tapped M6: the lead of the tap is 1 mm, so that F has to be S.
ONE_HOLE = """G21 G90 G54 G17 G94
T2 M6
G43 H2
S3000 M3
G0 X0 Y0 Z20
G99 G81 X0 Y0 Z-20 R5 F300
G80
T3 M6
G43 H3
S${rpm} M3
G0 X0 Y0 Z20
G99 G84 X0 Y0 Z-15 R5 F${feed}
G80
G0 Z50
M2
"""


def one_hole(rpm: int = 1000, feed: int | None = None) -> str:
    """Its text."""
    return ONE_HOLE.replace("${rpm}", str(rpm)).replace("${feed}", str(rpm if feed is None else feed))


@pytest.fixture
def plate() -> Path:
    return PLATE
