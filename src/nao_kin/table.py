"""Plain, coloured and HTML rendering of one kind of table, used by the command line and every `_repr_html_`."""

from __future__ import annotations

import html
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Iterable

    import rich.console
    import rich.table

__all__ = ["Column", "Style", "Table"]

Style: TypeAlias = Literal["", "good", "bad", "faint"]
_COLOURS = {"": "", "good": "green", "bad": "red", "faint": "dim"}

# The page around is the notebook's, light or dark: colours are of middle lightness, and everything else is inherited.
_CSS = {"": "", "good": "color:#2a9153", "bad": "color:#d6453d", "faint": "opacity:0.65"}
_TITLE = "text-align:left;font-weight:600"
_GAP = 3
"""Blanks between two columns on a terminal."""
_FOLDED = 40
"""Rows from which on a table in HTML is folded, so that a notebook stays a page one can read."""


@dataclass(frozen=True, slots=True)
class Column:
    """A column: its heading and whether its cells are numbers, which are set flush right."""

    heading: str
    number: bool = False


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of text under headings.

    Attributes:
        columns: The columns, left to right.
        rows: One tuple of texts a row, as many as there are columns.
        title: A line above, may be empty.
        note: A line below, may be empty.
        styles: For some rows (by index) how they are meant; colour only, never the sole carrier of meaning.
    """

    columns: tuple[Column, ...]
    rows: tuple[tuple[str, ...], ...]
    title: str = ""
    note: str = ""
    styles: dict[int, Style] = field(default_factory=dict)

    def __rich_console__(
        self, console: rich.console.Console, options: rich.console.ConsoleOptions
    ) -> rich.console.RenderResult:
        import rich.text

        # Lines of their own: rich would wrap a title to the width of a narrow table.
        if self.title:
            yield rich.text.Text(self.title, style="bold")
        for block, shown in enumerate(self._blocks(options.max_width)):
            if block:
                yield rich.text.Text("")
            yield self._rich_table(shown)
        if self.note:
            yield rich.text.Text(self.note)

    def _blocks(self, width: int) -> list[list[int]]:
        """Which columns stand side by side: all, unless names and then only numbers are wider than the terminal."""
        everything = list(range(len(self.columns)))
        if not all(column.number for column in self.columns[1:]):
            return [everything]  # texts fold
        widths = [max(map(len, texts)) for texts in zip(self._headings(), *self.rows, strict=True)]
        blocks: list[list[int]] = []
        for k in everything[1:]:
            if blocks and sum(widths[i] + _GAP for i in blocks[-1]) + widths[k] <= width:
                blocks[-1].append(k)
            else:
                blocks.append([0, k])
        return blocks or [everything]

    def _headings(self) -> tuple[str, ...]:
        return tuple(column.heading for column in self.columns)

    def _rich_table(self, shown: list[int]) -> rich.table.Table:
        import rich.box
        import rich.table
        import rich.text

        table = rich.table.Table(
            box=rich.box.SIMPLE_HEAD,
            show_edge=False,
            pad_edge=False,
            padding=(0, 1),
        )
        for column in (self.columns[k] for k in shown):
            table.add_column(
                rich.text.Text(column.heading),
                justify="right" if column.number else "left",
                no_wrap=column.number,
                overflow="fold",
            )
        for index, row in enumerate(self.rows):
            style = _COLOURS[self.styles.get(index, "")]
            # Text, not str: a link may be called "[red]" and must print as such.
            table.add_row(*(rich.text.Text(row[k]) for k in shown), style=style)
        return table

    def _repr_html_(self) -> str:
        """The table as a fragment of HTML, every text escaped; long ones are folded under their title."""
        note = f'<p style="white-space:pre-line">{html.escape(self.note)}</p>' if self.note else ""
        if len(self.rows) < _FOLDED:
            caption = f'<caption style="{_TITLE}">{html.escape(self.title)}</caption>' if self.title else ""
            return f"<table>{caption}{self._html_rows()}</table>{note}"
        count = html.escape(f"{self.title or 'table'} ({len(self.rows)} rows)")
        summary = f'<summary style="{_TITLE};cursor:pointer">{count}</summary>'
        return f"<details>{summary}<table>{self._html_rows()}</table></details>{note}"

    def _html_rows(self) -> str:
        def cells(tag: str, texts: Iterable[str], attributes: str = "") -> str:
            sides = ["right" if column.number else "left" for column in self.columns]
            return "".join(
                f'<{tag}{attributes} style="text-align:{side}">{html.escape(text)}</{tag}>'
                for text, side in zip(texts, sides, strict=True)
            )

        head = cells("th", (column.heading for column in self.columns), ' scope="col"')
        css = [_CSS[self.styles.get(index, "")] for index in range(len(self.rows))]
        openings = [f'<tr style="{style}">' if style else "<tr>" for style in css]
        body = "".join(f"{opening}{cells('td', row)}</tr>" for opening, row in zip(openings, self.rows, strict=True))
        return f"<thead><tr>{head}</tr></thead><tbody>{body}</tbody>"
