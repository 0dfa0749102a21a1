"""Machines: loaded, changed by key with the unit checked, shown."""

from __future__ import annotations

import pickle
from pathlib import Path

import leadscrew
import pytest
from leadscrew import Machine

from conftest import ROOT

PLAY = "axes.z.structure.backlash_um"


def test_every_built_in_machine_is_loaded() -> None:
    assert set(leadscrew.MACHINES) == {file.stem for file in (ROOT / "machines").glob("*.toml")}
    for name in leadscrew.MACHINES:
        assert Machine.load(name).name == name


def test_a_changed_value_is_read_back_and_the_first_machine_stays() -> None:
    machine = Machine.load("tapping-center")
    worn = machine.with_({PLAY: 12.5, "spindles.0.inertia_kg_m2": 0.02})
    assert worn[PLAY] == 12.5 and worn["spindles.spindle.inertia_kg_m2"] == 0.02
    assert machine[PLAY] == 1
    assert worn.with_({PLAY: 3})["spindles.0.inertia_kg_m2"] == 0.02


def test_a_key_with_another_unit_is_refused_and_the_right_one_is_named() -> None:
    with pytest.raises(leadscrew.Refused, match="did you mean `backlash_um`") as caught:
        Machine.load().with_({"axes.z.structure.backlash_mm": 0.01})
    assert caught.value.diagnostics[0].code == "S0402"


def test_a_value_out_of_bounds_is_refused_with_the_bounds() -> None:
    with pytest.raises(leadscrew.Refused, match="expected a number from 0"):
        Machine.load().with_({PLAY: -1})


def test_a_missing_key_is_a_key_error() -> None:
    with pytest.raises(KeyError):
        Machine.load()["axes.z.structure.play_um"]
    assert Machine.load().get("axes.z.structure.play_um", 7) == 7


def test_a_saved_machine_is_the_same_machine(tmp_path: Path) -> None:
    worn = Machine.load("lathe").with_({PLAY: 9})
    worn.save(tmp_path / "worn.toml")
    again = Machine.load(tmp_path / "worn.toml")
    assert again.text == worn.text and again[PLAY] == 9
    assert again.with_({PLAY: 8})[PLAY] == 8
    assert pickle.loads(pickle.dumps(worn)) == worn


def test_a_machine_is_shown_with_what_a_seed_makes_of_it() -> None:
    shown = Machine.load().with_({PLAY: 10}).show(seed=4)
    row = next(line for line in shown.splitlines() if "play" in line and " Z " in line.replace("|", " ").replace("│", " "))
    # the file's scatter is 20 %
    assert "10 µm" in row and "8 to 12 µm" in row, row
