"""The models of Debian's package sweethome3d-furniture that a scene names, taken out and made ready to be placed.

The package holds catalogues, zip files of OBJ models with a list that says each one's size, author and licence. A model
is written as a folder, scaled to metres and moved: y stays up, its front faces +z, the lowest point stands at y = 0 and
the box is centred in x and z. CREDITS.txt beside the folders says whose work they are.
"""

import io
import re
import shutil
import subprocess
import tarfile
import tempfile
import zipfile
from pathlib import Path

PACKAGE = "sweethome3d-furniture"
FORMAT = 1  # counts up when the same original would give another OBJ
INSTALLED = Path("/usr/share/sweethome3d/furniture")
# Licences under which a model may be changed and shown by anybody, without a condition on what it is shown with.
FREE = ("Public domain", "Creative Commons Attribution 3.0")
LIST = "PluginFurnitureCatalog.properties"


class FetchError(Exception):
    """A model could not be had; the text says which, why and what to do."""


def models_named(scene: str, folder: str) -> list[str]:
    """The models that the text of a scene file names as `FOLDER/CATALOGUE/.../MODEL.obj`: the paths in FOLDER."""
    return sorted(set(re.findall(rf'^file = "{re.escape(folder)}/([^"]+\.obj)"', scene, re.MULTILINE)))


def read_list(text: str):
    """What a catalogue's list says of all its models, and of each: {model's path: {key: value}}."""
    unescaped = re.sub(r"\\u([0-9a-fA-F]{4})", lambda code: chr(int(code[1], 16)), text)
    whole = dict(re.findall(r"^(\w+)=(.*?)\s*$", unescaped, re.MULTILINE))
    numbered = {}
    for key, number, value in re.findall(r"^(\w+)#(\d+)=(.*?)\s*$", unescaped, re.MULTILINE):
        numbered.setdefault(number, {})[key] = value
    return whole, {entry["model"].lstrip("/"): entry for entry in numbered.values() if "model" in entry}


def stood(obj: str, size, rotation=None) -> str:
    """The OBJ turned, scaled to a box of `size` (x, y, z) along its longest side, and stood on y = 0."""
    def turned(x, y, z):
        return tuple(r[0] * x + r[1] * y + r[2] * z for r in (rotation[0:3], rotation[3:6], rotation[6:9]))

    kinds, rows = [], []  # of the lines to rewrite; texture coordinates and faces stay as they are
    lines = obj.splitlines()
    for at, line in enumerate(lines):
        kind, _, rest = line.partition(" ")
        if kind == "v" or (kind == "vn" and rotation):
            values = tuple(map(float, rest.split()[:3]))
            kinds.append((at, kind))
            rows.append(turned(*values) if rotation else values)
    points = [row for row, (_, kind) in zip(rows, kinds) if kind == "v"]
    if not points:
        raise FetchError("a model without a vertex")
    low, high = [min(axis) for axis in zip(*points)], [max(axis) for axis in zip(*points)]
    scale = max(size) / max(h - l for l, h in zip(low, high))
    origin = ((low[0] + high[0]) / 2, low[1], (low[2] + high[2]) / 2)
    for (at, kind), row in zip(kinds, rows):
        if kind == "v":
            row = [(value - o) * scale + 0.0 for value, o in zip(row, origin)]
        lines[at] = f"{kind} %.6g %.6g %.6g" % tuple(row)
    return "\n".join(lines) + "\n"


def catalogues_in(folder: Path) -> dict[str, bytes]:
    """The catalogues of a folder that holds them, or the package; {name: content}."""
    found = {path.stem: path.read_bytes() for path in sorted(folder.glob("*.sh3f"))}
    packages = sorted(folder.glob(f"{PACKAGE}_*.deb"))
    if not found and packages:
        if not shutil.which("dpkg-deb"):
            raise FetchError(f"{packages[-1]}: only dpkg-deb unpacks it, which is not installed")
        unpacked = subprocess.run(["dpkg-deb", "--fsys-tarfile", packages[-1]], capture_output=True)
        if unpacked.returncode:
            raise FetchError(unpacked.stderr.decode(errors="replace").strip())
        with tarfile.open(fileobj=io.BytesIO(unpacked.stdout)) as archive:
            found = {Path(entry.name).stem: archive.extractfile(entry).read()
                     for entry in archive if entry.name.endswith(".sh3f")}
    if not found:
        raise FetchError(f"{folder} holds neither {PACKAGE}_*.deb nor its *.sh3f files")
    return found


def catalogues() -> dict[str, bytes]:
    if INSTALLED.is_dir():
        return catalogues_in(INSTALLED)
    by_hand = (f"put the package, from packages.debian.org/{PACKAGE}, in a folder and run "
               "`scenes/fetch town --from FOLDER`")
    if not shutil.which("apt-get"):
        raise FetchError(f"there is no apt-get to download Debian's package {PACKAGE} by; {by_hand}")
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(["apt-get", "download", "-q", PACKAGE], cwd=folder, text=True,
                              stdin=subprocess.DEVNULL, capture_output=True)
        if done.returncode:
            errors = [line for line in done.stderr.splitlines() if line.startswith("E:")]
            reason = "; ".join(errors) or done.stderr.strip()
            raise FetchError(f"`apt-get download {PACKAGE}` failed: {reason}; {by_hand}")
        return catalogues_in(Path(folder))


def fetch_models(names: list[str], source: Path | None, out: Path, title: str) -> str:
    """Writes the models named, and CREDITS.txt, into `out`; what is there is left. Returns what to say of it."""
    mark = out / ".complete"
    content = "\n".join([str(FORMAT), *names]) + "\n"
    if mark.is_file() and mark.read_text(encoding="utf-8") == content:
        return f"{out}: already there; {len(names)} models"
    opened = {}  # by the catalogue's name
    for catalogue, data in (catalogues_in(source) if source else catalogues()).items():
        archive = zipfile.ZipFile(io.BytesIO(data))
        opened[catalogue] = (archive, *read_list(archive.read(LIST).decode("latin-1")))
    lines = []
    for name in names:
        catalogue, _, path = name.partition("/")
        archive, whole, entries = opened.get(catalogue, (None, {}, {}))
        if path not in entries:
            raise FetchError(f"{PACKAGE} has no model {name}; the scene was made for version 1.8 of its catalogues")
        entry = whole | entries[path]
        if not entry["license"].startswith(FREE):
            raise FetchError(f"{name}: its licence is none by which it may be changed and shown: {entry['license']}")
        write_model(archive, path, entry, out / catalogue)
        lines.append(f"{name}: {entry['name']}, by {entry.get('creator', 'an unnamed author')}; {entry['license']}")
    (out / "CREDITS.txt").write_text(
        f"{title}\nAll are from Debian's package {PACKAGE}, where each catalogue's LICENSE.TXT has the terms whole.\n"
        "Changed: scaled to metres, turned and moved to stand on y = 0.\n\n" + "\n".join(lines) + "\n",
        encoding="utf-8")
    mark.write_text(content, encoding="utf-8")
    return f"{out}: {len(names)} models; credits: {out / 'CREDITS.txt'}"


def write_model(archive, path: str, entry, out: Path) -> None:
    """The model and all files of its folder."""
    for member in archive.namelist():
        if not member.startswith(path.rpartition("/")[0] + "/") or member.endswith("/"):
            continue
        if not (out / member).resolve().is_relative_to(out.resolve()):
            raise FetchError(f"{path}: its file {member} would be written elsewhere")
        data = archive.read(member)
        if member == path:
            size = [float(entry[key]) / 100 for key in ("width", "height", "depth")]  # of centimetres
            rotation = list(map(float, entry["modelRotation"].split())) if "modelRotation" in entry else None
            data = stood(data.decode("latin-1"), size, rotation).encode("latin-1")
        (out / member).parent.mkdir(parents=True, exist_ok=True)
        (out / member).write_bytes(data)
