"""What a study shows: figures of each characteristic, and a page with its distribution, effects and nearest case."""

from __future__ import annotations

import html
import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ._capability import Capability, capability
from ._effects import Effect, effects
from ._file import Characteristic, StudyFile

if TYPE_CHECKING:
    import pyarrow as pa


@dataclass(frozen=True, slots=True)
class Judged:
    """A characteristic, judged; ``why_not`` where it cannot be."""

    characteristic: Characteristic
    values: list[float]
    capability: Capability | None
    why_not: str
    effects: list[Effect]
    nearest: dict[str, Any] | None
    """The row that is nearest to its limit, or furthest beyond it."""
    room: float
    """From that row to the limit; negative beyond it."""


def judge(study: StudyFile, table: pa.Table) -> list[Judged]:
    """Every characteristic of a study."""
    return [_judged(study, table, each) for each in study.characteristics]


def _judged(study: StudyFile, table: pa.Table, of: Characteristic) -> Judged:
    if of.name not in table.column_names:
        return Judged(of, [], None, f"no case has measured {of.name}", [], None, math.nan)
    rows = [row for row in table.to_pylist() if of.of is None or row.get("kind") == of.of]
    rows = [row for row in rows if isinstance(row[of.name], (int, float)) and math.isfinite(row[of.name])]
    values = [float(row[of.name]) for row in rows]
    room = [min(_room(value, of)) for value in values]
    nearest = min(range(len(rows)), key=room.__getitem__) if rows else None
    try:
        found, why = capability(values, lower=of.lower, upper=of.upper), ""
    except ValueError as error:
        found, why = None, str(error)
    import pyarrow as pa

    told: list[Effect] = []
    if rows:
        factors = [name for name in study.factors if name in table.column_names]
        part = pa.table({name: [row[name] for row in rows] for name in [*factors, of.name]})
        told = effects(part, of.name, factors)
    return Judged(
        of, values, found, why, told, None if nearest is None else rows[nearest], math.nan if nearest is None else room[nearest]
    )


def _room(value: float, of: Characteristic) -> list[float]:
    return [*([value - of.lower] if of.lower is not None else []), *([of.upper - value] if of.upper is not None else [])]


def case_of(study: StudyFile, row: dict[str, Any]) -> dict[str, Any]:
    """The factors of a row."""
    return {name: row[name] for name in study.cases.column_names}


def text(study: StudyFile, table: pa.Table, judged: list[Judged], folder: Path) -> str:
    """For a terminal."""
    lines = [f"{study.title}: {study.cases.num_rows} cases, {table.num_rows} rows; {_endings(table)}"]
    for each in judged:
        of = each.characteristic
        lines.append(f"\n{of.name}{f' of a {of.of}' if of.of else ''}, {_limits(of)}")
        lines += [f"  {what:<28} {value}" for what, value in figures(each)]
        for effect in each.effects[:5]:
            lines.append(f"  {'effect of ' + ' × '.join(effect.factors):<60} {effect.effect:+.4g} ± {2 * effect.standard_error:.2g}")
        if each.nearest is not None:
            lines.append(f"  nearest to its limit: case {each.nearest['case']}, {each.room:+.4g} to it")
            lines.append(f"    {study.cut.command(case_of(study, each.nearest), folder / f'nearest-{of.name}')}")
    return "\n".join(lines) + "\n"


def figures(each: Judged) -> list[tuple[str, str]]:
    """What is known of a characteristic, in words."""
    found = each.capability
    if found is None:
        return [("not judged", each.why_not)]
    percent = f"{100 * found.confidence:.0f} %"
    said = [
        ("measured", f"{found.n}"),
        ("mean, standard deviation", f"{found.mean:.5g}, {found.standard_deviation:.3g}"),
    ]
    if found.cp is not None and found.cp_interval is not None:
        said.append(("Cp", f"{found.cp:.2f} ({found.cp_interval.low:.2f} to {found.cp_interval.high:.2f}, {percent})"))
    said.append(("Cpk", f"{found.cpk:.2f} ({found.cpk_interval.low:.2f} to {found.cpk_interval.high:.2f}, {percent})"))
    low, high = (1e4 * end for end in (found.out_interval.low, found.out_interval.high))
    said.append(("out of tolerance", f"{found.out} of {found.n}: {1e4 * found.out_share:.0f} in 10,000 ({low:.0f} to {high:.0f}, {percent})"))
    return said


def _limits(of: Characteristic) -> str:
    if of.lower is None:
        return f"at most {of.upper:g}"
    return f"at least {of.lower:g}" if of.upper is None else f"{of.lower:g} to {of.upper:g}"


def _endings(table: pa.Table) -> str:
    if "ending" not in table.column_names:
        return ""
    by_case = dict(zip(table["case"].to_pylist(), table["ending"].to_pylist(), strict=True))
    counts: dict[str, int] = {}
    for ending in by_case.values():
        counts[ending] = counts.get(ending, 0) + 1
    return ", ".join(f"{count} {ending}" for ending, count in sorted(counts.items()))


def page(study: StudyFile, table: pa.Table, judged: list[Judged], folder: Path) -> str:
    """For a browser: one file without scripts."""
    parts = [_chapter(study, each, folder) for each in judged]
    title = html.escape(study.title)
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title><style>
body {{ font: 16px/1.45 system-ui, sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; color: #1a2330 }}
table {{ border-collapse: collapse; margin: .6rem 0 }} td, th {{ padding: .2rem .9rem .2rem 0; text-align: left }}
code {{ background: #eef1f5; padding: .15rem .3rem; overflow-wrap: anywhere }} svg {{ width: 100%; height: auto }}
.bar {{ fill: #3b6ea8 }} .out {{ fill: #b3261e }} .limit {{ stroke: #b3261e; stroke-width: 2 }} text {{ font-size: 13px; fill: #1a2330 }}
</style></head><body><h1>{title}</h1>
<p>{study.cases.num_rows} cases of {html.escape(study.cut.program)} on {html.escape(study.cut.machine.name)}, {table.num_rows} rows;
{html.escape(_endings(table))}. Factors: {html.escape(", ".join(study.factors))}.</p>
{"".join(parts)}
</body></html>
"""


def _chapter(study: StudyFile, each: Judged, folder: Path) -> str:
    of = each.characteristic
    rows = "".join(f"<tr><th>{html.escape(what)}</th><td>{html.escape(value)}</td></tr>" for what, value in figures(each))
    told = "".join(
        f"<tr><td>{html.escape(' × '.join(e.factors))}</td><td>{e.effect:+.4g}</td><td>± {2 * e.standard_error:.2g}</td></tr>"
        for e in each.effects[:12]
    )
    told = f"<h3>Effects, from the low to the high end of a factor</h3><table>{told}</table>" if told else ""
    nearest = ""
    if each.nearest is not None:
        command = html.escape(study.cut.command(case_of(study, each.nearest), folder / f"nearest-{of.name}"))
        nearest = f"<h3>Nearest to its limit</h3><p>Case {each.nearest['case']}, {each.room:+.4g} to it:</p><p><code>{command}</code></p>"
    kind = f" of a {of.of}" if of.of else ""
    return f"<h2>{html.escape(of.name + kind)}: {_limits(of)}</h2>{histogram(each)}<table>{rows}</table>{told}{nearest}"


def histogram(each: Judged, width: int = 900, height: int = 240) -> str:
    """How the values lie between their limits."""
    of, values = each.characteristic, each.values
    if not values:
        return ""
    limits = [limit for limit in (of.lower, of.upper) if limit is not None]
    low, high = min([*values, *limits]), max([*values, *limits])
    room = 0.05 * (high - low) or 1.0
    low, high = low - room, high + room
    bins = max(10, min(60, round(2 * len(values) ** 0.5)))
    counts = [0] * bins
    for value in values:
        counts[min(bins - 1, int((value - low) / (high - low) * bins))] += 1
    top = max(counts)

    def x(value: float) -> float:
        return 10 + (value - low) / (high - low) * (width - 20)

    bars = []
    for at, count in enumerate(counts):
        left, right = (low + (high - low) * edge / bins for edge in (at, at + 1))
        is_out = (of.lower is not None and right <= of.lower) or (of.upper is not None and left >= of.upper)
        tall = (height - 60) * count / top
        style = "out" if is_out else "bar"
        bars.append(f'<rect class="{style}" x="{x(left):.1f}" y="{height - 30 - tall:.1f}" width="{x(right) - x(left) - 1:.1f}" height="{tall:.1f}"/>')
    lines = "".join(
        f'<line class="limit" x1="{x(limit):.1f}" x2="{x(limit):.1f}" y1="20" y2="{height - 30}"/>'
        f'<text x="{x(limit):.1f}" y="14" text-anchor="middle">{limit:g}</text>'
        for limit in limits
    )
    ends = "".join(
        f'<text x="{x(value):.1f}" y="{height - 10}" text-anchor="middle">{value:.4g}</text>' for value in (min(values), max(values))
    )
    return f'<svg viewBox="0 0 {width} {height}" role="img" aria-label="distribution of {html.escape(of.name)}">{"".join(bars)}{lines}{ends}</svg>'
