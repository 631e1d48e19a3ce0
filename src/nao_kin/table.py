"""Plain, coloured and HTML rendering of one kind of table, used by the command line and every `_repr_html_`."""

from __future__ import annotations

import html
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, TypeAlias

if TYPE_CHECKING:
    import rich.console

__all__ = ["Column", "Style", "Table"]

Style: TypeAlias = Literal["", "good", "bad", "faint"]
_COLOURS = {"": "", "good": "green", "bad": "red", "faint": "dim"}


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

    def __rich__(self) -> rich.console.Group:
        import rich.box
        import rich.console
        import rich.table
        import rich.text

        table = rich.table.Table(
            box=rich.box.SIMPLE_HEAD,
            show_edge=False,
            pad_edge=False,
            padding=(0, 1),
        )
        for column in self.columns:
            table.add_column(
                rich.text.Text(column.heading),
                justify="right" if column.number else "left",
                no_wrap=column.number,
                overflow="fold",
            )
        for index, row in enumerate(self.rows):
            style = _COLOURS[self.styles.get(index, "")]
            # Text, not str: a link may be called "[red]" and must print as such.
            table.add_row(*(rich.text.Text(cell) for cell in row), style=style)
        # Lines of their own: rich would wrap a title to the width of a narrow table.
        title = [rich.text.Text(self.title, style="bold")] if self.title else []
        note = [rich.text.Text(self.note)] if self.note else []
        return rich.console.Group(*title, table, *note)

    def _repr_html_(self) -> str:
        def cell(tag: str, text: str, column: Column) -> str:
            align = "right" if column.number else "left"
            return f'<{tag} style="text-align:{align}">{html.escape(text)}</{tag}>'

        head = "".join(cell("th", column.heading, column) for column in self.columns)
        body = "".join(
            "<tr>" + "".join(cell("td", text, column) for text, column in zip(row, self.columns, strict=True)) + "</tr>"
            for row in self.rows
        )
        caption = f"<caption>{html.escape(self.title)}</caption>" if self.title else ""
        note = f"<p>{html.escape(self.note)}</p>" if self.note else ""
        return f"<table>{caption}<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{note}"
