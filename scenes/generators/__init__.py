"""One module a scene. Each has `files()`, which returns {file name: bytes}."""

from . import cornell

SCENES = {
    "cornell": cornell.files,
}
