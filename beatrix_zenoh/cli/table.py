"""Aligned columns that read the same on a screen and in a pipe."""

from __future__ import annotations

from collections.abc import Sequence

GAP = "  "


def columns(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Text with one line per row under its heads; numbers are aligned to the right."""
    lines = [list(heads), *(list(row) for row in rows)]
    widths = [max(len(line[i]) for line in lines) for i in range(len(heads))]
    right = [bool(rows) and all(numeric(row[i]) for row in rows) for i in range(len(heads))]
    return "\n".join(
        GAP.join(
            cell.rjust(width) if to_right else cell.ljust(width)
            for cell, width, to_right in zip(line, widths, right, strict=True)
        ).rstrip()
        for line in lines
    )


def numeric(cell: str) -> bool:
    """It begins with a number, or says that there is none."""
    return cell == "-" or cell.lstrip("+-")[:1].isdigit()
