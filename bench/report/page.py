"""index.html: all charts of a folder on one page that opens from disk."""

from html import escape

STYLE = """
body { font-family: sans-serif; max-width: 1300px; margin: 2em auto; padding: 0 1em; color: #222; }
figure { margin: 2.5em 0; } figure img { max-width: 100%; } figcaption { color: #555; max-width: 60em; }
table { border-collapse: collapse; font-size: 85%; } td, th { padding: 0.2em 0.7em; text-align: right; }
th { border-bottom: 1px solid #999; } td:first-child, th:first-child { text-align: left; } code { font-size: 90%; }
.row { display: flex; flex-wrap: wrap; gap: 1em; } .row figure { margin: 0; width: 256px; }
.row img { width: 256px; image-rendering: pixelated; }
"""


def write(folder, results, charts, pictures, tables):
    machine = results["machine"]
    parts = ["<!doctype html>", '<html lang="en"><head><meta charset="utf-8"><title>Raylab: measurements</title>',
             f"<style>{STYLE}</style></head><body>", "<h1>Raylab: speed beside accuracy</h1>",
             "<p>" + escape(", ".join(f"{name.replace('_', ' ')}: {value}" for name, value in machine.items())) + "</p>",
             "<ul>"]
    for run in results.get("runs", []):
        note = "" if run.get("complete", True) else " <strong>interrupted: only a part was measured</strong>"
        parts.append(f"<li><code>{escape(run['command'])}</code>, {escape(run['date'])}{note}</li>")
    parts.append('</ul><p>All rows: <a href="results.csv">results.csv</a>, <a href="results.json">results.json</a>.</p>')
    for name, caption in charts:
        parts.append(f'<figure><img src="{escape(name)}.svg" alt="{escape(caption)}">'
                     f"<figcaption>{escape(caption)}</figcaption></figure>")
    parts += tables
    if pictures:
        parts.append("<h2>Where pictures differ</h2><div class=\"row\">")
        parts += [f'<figure><img src="{escape(name)}" alt="{escape(caption)}"><figcaption>{escape(caption)}</figcaption>'
                  "</figure>" for name, caption in pictures]
        parts.append("</div>")
    if not charts:
        parts.append("<p>There are no rows to draw yet.</p>")
    parts.append("</body></html>")
    (folder / "index.html").write_text("\n".join(parts) + "\n", encoding="utf-8")
