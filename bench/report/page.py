"""index.html: the answer first, then the charts, then how it was measured; one file that needs no other."""

from html import escape
from pathlib import Path
from string import Template

import style
import svg


def figure(chart, drawings):
    """A chart for wide and for narrow windows, of which the style sheet shows one."""
    drawings = "\n".join(f'<div class="{shape}">{svg.inlined(text, f"{chart.name}-{shape}", chart.says)}</div>'
                         for shape, text in drawings.items())
    reading = f'<p class="reading">{escape(chart.reading)}</p>' if chart.reading else ""
    return (f'<figure id="{escape(chart.name)}">{drawings}\n<figcaption><p>{escape(chart.says)}</p>{reading}'
            "</figcaption></figure>")


def command(run):
    note = "" if run.get("complete", True) else " <strong>interrupted: only a part was measured</strong>"
    return f"<li><code>{escape(run['command'])}</code>, {escape(run['date'][:10])}{note}</li>"


def write(folder, results, answer, figures, tables):
    """Writes the page. answer, figures, tables: its sections, in HTML."""
    template = Template(Path(__file__).with_name("page.html").read_text(encoding="utf-8"))
    figures, rules = svg.with_classes("\n".join(["<h2>Charts</h2>", *figures] if figures else
                                                ["<p>There are no rows to draw yet.</p>"]))
    text = template.substitute(
        light=svg.variables(False), dark=svg.variables(True), rules=rules, answer=answer, charts=figures,
        tables="\n".join(tables), machine=escape(style.machine_of(results)),
        commands="\n".join(map(command, results.get("runs", []))))
    (folder / "index.html").write_text(text, encoding="utf-8")
