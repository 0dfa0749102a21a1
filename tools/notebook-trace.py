#!/usr/bin/env python3
"""Records the trace that the fourth notebook fits a machine to, docs/notebooks/measured-z.csv, anew: after a change of how the control
plans or moves. The machine and the moves are those of the notebook, with the play and the friction that it says at its end; time,
noise and its seed are always the same, so that the same control writes the same file.

    python tools/notebook-trace.py [FILE]      FILE: docs/notebooks/measured-z.csv, unless said. Needs what python/ needs, and scipy.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import leadscrew
import matplotlib
import numpy as np

NOTEBOOKS = Path(__file__).resolve().parent.parent / "docs" / "notebooks"
NOTEBOOK = NOTEBOOKS / "4-machine-parameters-from-a-measured-trace.ipynb"
HIDDEN = {"backlash_um": 8.5, "coulomb_n": 240.0, "viscous": 850.0}
STATIC = 1.25  # static over Coulomb friction, as in the notebook
PERIOD_S, NOISE_MM, NOISE_N, SEED = 1e-3, 1e-3, 40.0, 4


def notebook() -> dict:
    """What the notebook's first cells define: its moves, its machine, the keys of what is fitted."""
    matplotlib.use("Agg")
    cells = [cell for cell in json.loads(NOTEBOOK.read_text())["cells"] if cell["cell_type"] == "code"]
    names: dict = {}
    for cell in cells[:2]:
        exec("".join(cell["source"]), names)
    return names


def main() -> None:
    of = notebook()
    values = {of["KEYS"][name]: value for name, value in HIDDEN.items()}
    machine = of["exact"].with_(values | {"axes.z.friction.static_n": STATIC * HIDDEN["coulomb_n"]})
    trace = leadscrew.run("moves.ngc", text=of["MOVES"], machine="tapping-center", plant=machine, trace=True).trace
    time = trace["time_s"].to_numpy()
    at = np.arange(int(time[-1] / PERIOD_S) + 1) * PERIOD_S
    motor, table, force = (np.interp(at, time, trace[name].to_numpy()) for name in ("z_encoder_mm", "z_truth_mm", "z_drive_force_n"))
    noise = np.random.default_rng(SEED)
    table = table + noise.normal(0, NOISE_MM, len(at))
    force = force + noise.normal(0, NOISE_N, len(at))
    rows = [f"{t:.5f},{m:.6f},{x:.5f},{f:.1f}\n" for t, m, x, f in zip(at, motor, table, force)]
    text = "time_s,z_motor_mm,z_table_mm,z_force_n\n" + "".join(rows)
    Path(sys.argv[1] if len(sys.argv) > 1 else NOTEBOOKS / "measured-z.csv").write_text(text)


if __name__ == "__main__":
    main()
