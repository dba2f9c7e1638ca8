"""Reads results.json and holds its rows to the schema that raylab-bench writes them by."""

import json
from pathlib import Path

SCHEMA = {field["name"]: field for field in json.loads(Path(__file__).with_name("schema.json").read_text())["fields"]}
VERSION = 1  # of the format of results.json, as raylab-bench writes it; files without one are older
TYPES = {"string": str, "strings": list, "boolean": bool, "integer": int, "number": (int, float)}


class RowError(Exception):
    """What is wrong with a row, by the row's place and the field's name, or with the whole document."""


class Row(dict):
    """A row that names itself when a chart asks for a field that it lacks."""

    def __init__(self, place, fields):
        super().__init__(fields)
        self.place = place

    def __missing__(self, name):
        raise RowError(f"{self.place}: lacks the field {name}")


def has_type(value, name):
    if name != "boolean" and isinstance(value, bool):  # which Python takes for an integer
        return False
    return isinstance(value, TYPES[name])


def fault(row):
    """What keeps the row from conforming to the schema; empty when it conforms."""
    for name, value in row.items():
        field = SCHEMA.get(name)
        if field is None:
            return f"{name}: no field of the schema"
        parts = field.get("parts")
        if parts:
            good = isinstance(value, dict) and set(value) == set(parts) and all(
                has_type(part, field["type"]) for part in value.values())
        else:
            good = has_type(value, field["type"])
        if not good:
            return f"{name}: expected {field['type']}" + (f" for each of {', '.join(parts)}" if parts else "")
        if row.get("suite") not in field.get("suites", [row.get("suite")]):
            return f"{name}: no field of the suite {row.get('suite')}"
    return "" if "suite" in row else "suite: expected string"


def read_results(file):
    """The document, with Rows for its rows. Raises RowError for a row that does not conform to the schema, and for a
    document of a later version."""
    results = json.loads(file.read_text(encoding="utf-8"))
    if (version := results.get("version", VERSION)) not in range(1, VERSION + 1):
        raise RowError(f"its results are of format version {version}, and this program reads {VERSION}")
    rows = []
    for i, fields in enumerate(results["rows"]):
        if problem := fault(fields):
            raise RowError(f"rows[{i}]: {problem}")
        rows.append(Row(f"rows[{i}]", fields))
    return {**results, "rows": rows}
