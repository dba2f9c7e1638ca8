"""One module a scene. Each has `files()`, which returns {file name: bytes}."""

from . import bunny, caustics, cornell, dragon, forest, globe, kaleidoscope, lamps, mirror_room, one_weekend, town

SCENES = {
    "cornell": cornell.files,
    "one-weekend": one_weekend.files,
    "mirror-room": mirror_room.files,
    "dragon": dragon.files,
    "bunny": bunny.files,
    "globe": globe.files,
    "forest": forest.files,
    "lamps": lamps.files,
    "caustics": caustics.files,
    "kaleidoscope": kaleidoscope.files,
    "town": town.files,
}
