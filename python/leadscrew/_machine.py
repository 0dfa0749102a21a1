"""Machines: built-in models and files, with values changed."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from . import _leadscrew as _native

#: Names of the built-in models; the first is the default.
MACHINES: tuple[str, ...] = tuple(_native.MACHINES)

Value: TypeAlias = float | int | str | bool


@dataclass(frozen=True, slots=True)
class Machine:
    """A machine, as its file describes it. It is not changed: :meth:`with_` makes another one.

    Every key carries its unit in its name, and every value is checked by the reader of machine files:

    >>> worn = Machine.load("tapping-center").with_({"axes.z.structure.backlash_um": 12})
    >>> worn["axes.z.structure.backlash_um"]
    12
    """

    name: str
    """Name of the built-in model, or the file's path."""
    text: str
    """The machine file."""

    @classmethod
    def load(cls, name: str | os.PathLike[str] = "tapping-center") -> Machine:
        """A built-in model by its name (see :data:`MACHINES`), or a file; :class:`Refused` with all that is wrong with it."""
        name = os.fspath(name)
        return cls(name, _native.machine_text((name, None)))

    @classmethod
    def parse(cls, text: str, name: str = "machine.toml") -> Machine:
        """A machine from the text of its file."""
        return cls(name, _native.machine_text((name, text)))

    def with_(self, changes: Mapping[str, Value]) -> Machine:
        """The same machine with values changed by their keys, such as ``"axes.z.structure.backlash_um"`` or
        ``"spindles.0.inertia_kg_m2"``. All are changed, then the file is checked.

        :class:`Refused`: a key that there is not (one with another unit gets the right one named), a value out of its
        bounds, values that contradict each other.
        """
        pairs = [(key, _plain(value)) for key, value in changes.items()]
        source = self._source() if self.name not in MACHINES else (self.name, self._own())
        return Machine(self.name, _native.machine_changed(source, json.dumps(pairs)))

    def get(self, key: str, default: Any = None) -> Any:
        """A value by its key, as this file or one that it extends states it."""
        found = _native.machine_value(self.text, key)
        return default if found is None else json.loads(found)

    def __getitem__(self, key: str) -> Any:
        found = _native.machine_value(self.text, key)
        if found is None:
            raise KeyError(key)
        return json.loads(found)

    def show(self, seed: int | None = None, part: int = 1) -> str:
        """The file, and what the simulated machine may be other than its control believes; for a seed
        and a workpiece by its number (from 1), what it is."""
        return _native.machine_shown(self._source(), seed, part)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the file, for ``--machine``."""
        Path(path).write_text(self.text, encoding="utf-8")

    def _own(self) -> str | None:
        """The text, unless it is that of the built-in model."""
        return None if self.text == _native.machine_text((self.name, None)) else self.text

    def _source(self) -> tuple[str, str | None]:
        return (self.name, self.text)

    def __repr__(self) -> str:
        return f"Machine({self.name!r})"


def source(machine: Machine | str | os.PathLike[str] | None) -> tuple[str, str | None] | None:
    """What the native part takes for a machine."""
    if machine is None:
        return None
    if isinstance(machine, Machine):
        return machine._source()
    return (os.fspath(machine), None)


def _plain(value: Any) -> Value:
    """Numbers of numpy as Python's."""
    plain: Value = value.item() if hasattr(value, "item") else value
    return plain
