"""Charts within the page: scalable, named for those who cannot see them, legible on light and on dark paper."""

import re
from html import escape

import style


def inlined(text, name, label):
    """An SVG file's text as an element in HTML: its ids are its own, its colours the page's."""
    text = text[text.index("<svg"):]
    text = re.sub(r"<metadata>.*?</metadata>|<!--.*?-->", "", text, flags=re.DOTALL)
    used = set(re.findall(r'(?:url\(|href=")#([^")]+)', text))
    text = re.sub(r' id="([^"]*)"', lambda m: f' id="{name}-{m[1]}"' if m[1] in used else "", text)
    text = re.sub(r'(url\(|href=")#', rf"\1#{name}-", text).replace("xlink:href", "href")
    text = re.sub(r"<[^>]*>", lambda tag: shortened(tag.group()), text)
    text = re.sub(r"\s*\n\s*", "\n", text)
    text = re.sub(r"<g>\n((?:<use[^>]*>|<text[^>]*>[^<]*</text>|<path[^>]*>)\n)</g>", r"\1", text)
    width = re.search(r'width="([\d.]+)pt"', text).group(1)
    text = re.sub(r'(<svg[^>]*?) width="[^"]*"', rf'\1 style="width: {width}pt"', text, count=1)
    text = re.sub(r'(<svg[^>]*?) height="[^"]*"', r"\1", text, count=1)
    return text.replace("<svg", f'<svg role="img" aria-label="{escape(label)}"', 1)


def shortened(tag):
    """A tag with coordinates to a hundredth of a point and the colours of the page's scheme."""
    tag = re.sub(r"\d+\.\d{3,}", lambda m: f"{float(m.group()):.2f}", tag)
    tag = re.sub(r' transform="rotate\(-0 [^"]*"', "", tag)
    return re.sub(r"#[0-9a-fA-F]{6}\b", lambda m: f"var(--c{m[0][1:].lower()})" if m[0].upper() in style.DARK else m[0],
                  tag)


def with_classes(text):
    """The HTML with each style attribute as a class, which the charts have by the thousand, and their style sheet."""
    rules = {}
    text = re.sub(r' style="([^"]*)"', lambda m: f' class="s{rules.setdefault(m[1], len(rules))}"', text)
    return text, "\n".join(f".s{i} {{ {rule} }}" for rule, i in rules.items())


def variables(dark):
    """The values of the charts' colours in the page's light or dark scheme."""
    return " ".join(f"--c{light[1:].lower()}: {other if dark else light};" for light, other in style.DARK.items())
