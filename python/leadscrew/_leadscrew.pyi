"""The native part: words of the command line in, JSON out."""

from collections.abc import Callable
from typing import Literal, final

__all__ = [
    "__version__",
    "BUILD",
    "MACHINES",
    "RunResult",
    "Trace",
    "main",
    "check",
    "canon",
    "time",
    "polygon",
    "cam",
    "run",
    "machine_text",
    "machine_changed",
    "machine_value",
    "machine_shown",
    "unit_of",
]

__version__: str
BUILD: str
MACHINES: list[str]

def main(words: list[str]) -> int: ...
def check(
    words: list[str], program: bytes | None = None, machine: tuple[str, str | None] | None = None
) -> str: ...
def canon(
    words: list[str], program: bytes | None = None, machine: tuple[str, str | None] | None = None
) -> str: ...
def time(
    words: list[str], program: bytes | None = None, machine: tuple[str, str | None] | None = None
) -> str: ...
def polygon(words: list[str], machine: tuple[str, str | None] | None = None) -> str: ...
def cam(words: list[str], machine: tuple[str, str | None] | None = None) -> str: ...
def run(
    words: list[str],
    program: bytes | None = None,
    machine: tuple[str, str | None] | None = None,
    plant: tuple[str, str | None] | None = None,
    *,
    trace: bool = False,
    progress: Callable[[float, float], object] | None = None,
) -> RunResult: ...
def machine_text(machine: tuple[str, str | None]) -> str: ...
def machine_changed(machine: tuple[str, str | None], changes: str) -> str: ...
def machine_value(text: str, key: str) -> str | None: ...
def machine_shown(machine: tuple[str, str | None], seed: int | None = None, part: int = 1) -> str: ...
def unit_of(name: str) -> str: ...
@final
class RunResult:
    @property
    def ending(self) -> Literal["good", "out-of-tolerance", "alarm"]: ...
    @property
    def trace(self) -> Trace | None: ...
    def certificate(self) -> str: ...
    def findings(self) -> str: ...
    def events(self) -> list[tuple[float, int, str, str]]: ...
    def notes(self) -> list[str]: ...
    def report(self) -> str: ...

@final
class Trace:
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...
    def __len__(self) -> int: ...
