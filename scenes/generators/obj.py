"""A small writer for Wavefront OBJ: vertices are shared, numbers are short."""


def number(value, decimals):
    """`value` with at most `decimals` digits after the point: 555, 0.25, -1.5."""
    text = f"{value:.{decimals}f}"
    if decimals:
        text = text.rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


class Obj:
    """Collects faces and writes each distinct position, texture coordinate and normal once."""

    def __init__(self, mtllib, comment, decimals=3):
        self._header = [f"# {comment}", f"mtllib {mtllib}"]
        self._decimals = decimals
        self._tables = {"v": {}, "vt": {}, "vn": {}}
        self._faces = []
        self.triangles = 0

    def use(self, material):
        """Faces from here on have this material."""
        self._faces.append(f"usemtl {material}")

    def _index(self, kind, values, decimals):
        line = " ".join(number(value, decimals) for value in values)
        table = self._tables[kind]
        return table.setdefault(line, len(table) + 1)

    def face(self, points, uvs=None, normals=None):
        """A convex polygon, anticlockwise seen from outside. One uv for all corners may be given as a pair."""
        corners = [str(self._index("v", point, self._decimals)) for point in points]
        if len(set(corners)) != len(corners):
            raise ValueError(f"two corners of a face are one after rounding: {points}")
        if uvs is not None:
            shared = not hasattr(uvs[0], "__len__")
            corners = [f"{c}/{self._index('vt', uvs if shared else uvs[i], 6)}" for i, c in enumerate(corners)]
        if normals is not None:
            slash = "/" if uvs is not None else "//"
            corners = [f"{c}{slash}{self._index('vn', normals[i], 4)}" for i, c in enumerate(corners)]
        self._faces.append("f " + " ".join(corners))
        self.triangles += len(points) - 2

    def encode(self):
        lines = self._header + [f"# {self.triangles} triangles"]
        for kind, table in self._tables.items():
            lines += [f"{kind} {line}" for line in table]
        return ("\n".join(lines + self._faces) + "\n").encode()
