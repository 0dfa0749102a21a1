"""The usual function of a study: a program is cut on a machine, and its features are measured."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from pathlib import Path as FilePath
from string import Template
from typing import Any, cast

from .._api import run
from .._errors import Refused
from .._machine import Machine, Value
from .._options import RunOptions


class Cut:
    """Cuts a program and answers with a row for each feature: its measures by their names in the certificate, and
    ``ending``, ``alarm`` (its number), ``cycle_time_s`` of the run.

    A factor of a case is

    - ``machine.KEY``: a value of the machine file, for control and plant alike;
    - ``plant.KEY``: the same for the simulated machine alone: the control goes on believing ``machine``;
    - ``program.NAME``: what stands for ``${NAME}`` in the program's text;
    - any option of :func:`leadscrew.run`: ``seed``, ``material``, ``tapping_preset``, ``synchronisation``, ``fault``, ….

    A case that ends in an alarm, or is refused, is a result like any other: ``ending`` is ``"alarm"`` or ``"refused"``, and
    ``reason`` says why.
    """

    def __init__(
        self,
        program: str | os.PathLike[str],
        *,
        machine: Machine | str = "tapping-center",
        plant: Machine | str | None = None,
        text: str | None = None,
        options: RunOptions | None = None,
    ) -> None:
        self.program = os.fspath(program)
        self.text = FilePath(program).read_text(encoding="utf-8") if text is None else text
        self.machine = machine if isinstance(machine, Machine) else Machine.load(machine)
        self.plant = plant if isinstance(plant, Machine) or plant is None else Machine.load(plant)
        self.options: RunOptions = options or {}

    @property
    def fingerprint(self) -> str:
        """Hash of all that a case depends on beside its factors."""
        plant = None if self.plant is None else self.plant.text
        files = {}
        for name, value in self.options.items():
            if name in ("tools", "parameters", "inputs", "cams", "phase_table") and value is not None:
                files[name] = hashlib.sha256(FilePath(cast(str, value)).read_bytes()).hexdigest()
        known = [self.program, self.text, self.machine.text, plant, dict(self.options), files]
        return hashlib.sha256(json.dumps(known, default=str, sort_keys=True).encode()).hexdigest()

    def arguments(self, case: Mapping[str, Any]) -> dict[str, Any]:
        """What :func:`leadscrew.run` is called with for a case; :class:`leadscrew.Refused` where a factor is none."""
        of_machine: dict[str, Value] = {}
        of_plant: dict[str, Value] = {}
        words: dict[str, Any] = {}
        options: dict[str, Any] = dict(self.options)
        for factor, value in case.items():
            where, _, key = factor.partition(".")
            if where == "machine" and key:
                of_machine[key] = value
            elif where == "plant" and key:
                of_plant[key] = value
            elif where == "program" and key:
                words[key] = value
            elif factor in RunOptions.__annotations__ or factor in _INHERITED:
                options[factor] = value
            else:
                raise Refused(
                    f"the factor {factor} is none: expected machine.KEY, plant.KEY, program.NAME or an option such as seed or material"
                )
        machine = self.machine.with_(of_machine) if of_machine else self.machine
        plant = self.plant
        if of_plant:
            plant = (self.plant or machine).with_(of_plant)
        try:
            text = Template(self.text).substitute({name: _word(value) for name, value in words.items()}) if words else self.text
        except (KeyError, ValueError) as wrong:
            raise Refused(f"{self.program}: a placeholder has no factor program.NAME: {wrong}") from None
        for name in words:
            if "${" + name + "}" not in self.text:
                raise Refused(f"{self.program} has no ${{{name}}} for the factor program.{name}")
        return {"program": self.program, "machine": machine, "plant": plant, "text": text, **options}

    def __call__(self, case: Mapping[str, Any]) -> list[dict[str, Any]]:
        try:
            arguments = self.arguments(case)
            result = run(arguments.pop("program"), **arguments)
        except Refused as refused:
            return [{"ending": "refused", "reason": str(refused)}]
        certificate = result.certificate
        alarms = certificate["alarms"]
        whole = {
            "ending": result.ending,
            "alarm": alarms[0]["number"] if alarms else None,
            "cycle_time_s": certificate["cycle_time_s"],
        }
        rows = [{**_scalars(feature), **whole} for feature in certificate["features"]]
        reason = alarms[0]["text"] if alarms else "nothing was cut"
        return rows or [{"reason": reason, **whole}]

    def command(self, case: Mapping[str, Any], folder: str | os.PathLike[str]) -> str:
        """The command that repeats a case; files that it needs are written into ``folder``."""
        import shlex

        from .._options import words

        arguments = self.arguments(case)
        at = FilePath(folder)
        at.mkdir(parents=True, exist_ok=True)
        program = arguments.pop("program")
        text = arguments.pop("text")
        if not FilePath(program).is_file() or text != FilePath(program).read_text(encoding="utf-8"):
            program = str(at / "case.ngc")
            FilePath(program).write_text(text, encoding="utf-8")
        said = ["leadscrew", "run", program]
        for name in ("machine", "plant"):
            machine = arguments.pop(name)
            if machine is None:
                continue
            known = machine.name
            if known == "tapping-center" and name == "machine" and machine == self.machine:
                continue
            if machine.text != Machine.load(known).text:
                known = str(at / f"{name}.toml")
                machine.save(known)
            said += [f"--{name}", known]
        return shlex.join([*said, *words(arguments)])


_INHERITED = frozenset(name for base in RunOptions.__mro__ for name in getattr(base, "__annotations__", {})) | frozenset(
    RunOptions.__required_keys__ | RunOptions.__optional_keys__
)


def _word(value: Any) -> str:
    """A number as programs have it: without an exponent."""
    if isinstance(value, float):
        text = f"{value:.6f}".rstrip("0").rstrip(".")
        return "0" if text in ("-0", "") else text
    return str(value)


def _scalars(feature: Mapping[str, Any], under: str = "") -> dict[str, Any]:
    """What is nested gets a name of both; lists are left out."""
    row: dict[str, Any] = {}
    for key, value in feature.items():
        if isinstance(value, Mapping):
            row.update(_scalars(value, f"{under}{key}_"))
        elif not isinstance(value, list):
            row[under + key] = value
    return row
