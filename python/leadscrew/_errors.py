"""What was found wrong, and the exception that carries it."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One finding: what is wrong, where, and what works.

    ``code`` is stable, such as ``"I0408"`` (``None``: a sentence without a code); ``severity`` is ``"error"``,
    ``"warning"`` or ``"note"``; ``line`` and ``column`` count from 1 (``None``: there is no place).
    """

    code: str | None
    severity: str
    text: str
    remedy: str | None
    file: str | None
    line: int | None
    column: int | None
    end_column: int | None
    labels: tuple[tuple[str, int], ...] = ()
    """Other places that explain it: text and line."""

    @classmethod
    def _of(cls, found: Mapping[str, Any]) -> Diagnostic:
        place = found["place"] or {}
        return cls(
            code=found["code"],
            severity=found["severity"],
            text=found["message"],
            remedy=found["help"],
            file=found["file"],
            line=place.get("line"),
            column=place.get("column"),
            end_column=place.get("end_column"),
            labels=tuple((label["text"], label["place"]["line"]) for label in found["labels"]),
        )

    def __str__(self) -> str:
        place = "" if self.line is None else f"{self.file}:{self.line}:{self.column}: "
        code = "" if self.code is None else f"[{self.code}]"
        remedy = "" if self.remedy is None else f" ({self.remedy})"
        return f"{place}{self.severity}{code}: {self.text}{remedy}"


class Refused(Exception):
    """A program, a machine or an option is refused; ``diagnostics`` say why, where, and what would work.

    An alarm on the machine and a workpiece out of tolerance are no exceptions: :class:`leadscrew.Result` says them.
    """

    diagnostics: tuple[Diagnostic, ...]

    def __init__(self, sentence: str, diagnostics: Sequence[Diagnostic] = ()) -> None:
        super().__init__(sentence, tuple(diagnostics))
        self.sentence = sentence
        self.diagnostics = tuple(diagnostics)

    @classmethod
    def _of(cls, sentence: str, findings: str) -> Refused:
        return cls(sentence, [Diagnostic._of(found) for found in json.loads(findings)])

    def __str__(self) -> str:
        wrong = [str(found) for found in self.diagnostics if found.severity == "error" and found.line is not None]
        return "\n".join([self.sentence, *wrong])
