"""The best settings of each peer for each scene, as far as they were searched: README.md has the measurements.

The options of the peer's command by peer and scene; `otherwise`: for scenes that were not measured, and what a scene
does not name.
"""

NEVER = 1000  # segments or bounces: more than any scene has

BEST = {
    "mitsuba": {
        "otherwise": {"variant": "llvm_ad_rgb", "sampler": "multijitter", "rr_depth": 5, "one_sided_lights": False},
        "bunny": {"rr_depth": NEVER},
        "cornell": {"rr_depth": NEVER},
        "dragon": {"one_sided_lights": True},
        "forest": {"rr_depth": 3},
        "globe": {"one_sided_lights": True, "rr_depth": 3},
        "one-weekend": {"rr_depth": NEVER},
    },
    "cycles": {
        "otherwise": {"variant": "CPU", "sampler": "TABULATED_SOBOL", "rr_depth": 5, "emission_sampling": "AUTO",
                      "background_sampling": "AUTOMATIC", "light_tree": False, "guiding": False},
        "bunny": {"background_sampling": "NONE"},
        "cornell": {"rr_depth": 0},
        "forest": {"background_sampling": "NONE", "rr_depth": 0},
        "one-weekend": {"background_sampling": "NONE"},
    },
    "luxcore": {
        "otherwise": {"variant": "PATHCPU", "sampler": "SOBOL", "rr_depth": 5, "light_strategy": "LOG_POWER",
                      "one_sided_lights": False},
        "bunny": {"sampler": "RANDOM"},
        "cornell": {"sampler": "RANDOM"},
        "dragon": {"sampler": "RANDOM"},
        "globe": {"one_sided_lights": True},
        "mirror-room": {"sampler": "RANDOM"},
        "one-weekend": {"sampler": "RANDOM"},
    },
}
