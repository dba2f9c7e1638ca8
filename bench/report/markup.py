"""Tables of the page: sortable where a script runs, and telling why a cell is empty."""

from html import escape
from typing import NamedTuple, Optional

from style import number


class Cell(NamedTuple):
    """A cell's text, what it is sorted by, what stands small beneath it, whether it is among its column's best."""

    text: str
    value: Optional[float] = None
    below: str = ""
    best: bool = False
    why: str = ""  # it is empty

    def html(self, notes):
        if self.why:
            return f'<td>–<sup>{note_of(self.why, notes)}</sup></td>'
        text = f"<strong>{escape(self.text)}</strong>" if self.best else escape(self.text)
        below = f"<small>{escape(self.below)}</small>" if self.below else ""
        value = "" if self.value is None else f' data-value="{self.value:.9g}"'
        return f"<td{value}>{text}{below}</td>"


def number_cell(value):
    return Cell(number(value), value)


def spread_cell(spread):
    """A median, and least and most of all repeats beneath it."""
    return Cell(number(spread["median"]), spread["median"], f"{number(spread['min'])}–{number(spread['max'])}")


def text_cell(text):
    wraps = ' class="text"' if len(text) > 40 else ""
    return f"<td{wraps}>{escape(text)}</td>"


def missing(why):
    """An empty cell, and why it is."""
    return Cell("", why=why)


def note_of(why, notes):
    """The letter under which the table says why: equal reasons share one."""
    if why not in notes:
        notes.append(why)
    return chr(ord("a") + notes.index(why))


def table(head, rows, groups=()):
    """HTML of a table in a box of its own that scrolls. Cells are Cells or strings; groups: (label, columns) above."""
    notes = []
    body = ["<tr>" + "".join(cell.html(notes) if isinstance(cell, Cell) else text_cell(cell) for cell in row) + "</tr>"
            for row in rows]
    above = "".join(f'<th colspan="{columns}">{escape(label)}</th>' for label, columns in groups)
    parts = ['<div class="scrolls"><table>', "<thead>", f'<tr class="groups">{above}</tr>' if groups else "",
             "<tr>" + "".join(f'<th scope="col">{escape(label)}</th>' for label in head) + "</tr>", "</thead><tbody>",
             *body, "</tbody></table></div>"]
    if notes:
        parts.append('<p class="notes">' + " ".join(f"<span><sup>{note_of(why, notes)}</sup> {escape(why)}.</span>"
                                                    for why in notes) + "</p>")
    return "\n".join(part for part in parts if part)
