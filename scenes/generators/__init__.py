"""One module a scene. Each has `files()`, which returns {file name: bytes}."""

from . import cornell, dragon, one_weekend

SCENES = {
    "cornell": cornell.files,
    "one-weekend": one_weekend.files,
    "dragon": dragon.files,
}
