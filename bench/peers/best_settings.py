"""The best settings of each peer for each scene, as far as they were searched: README.md has the measurements.

The options of the peer's command by peer and scene; `otherwise`: for scenes that were not measured.
"""

BEST = {
    "mitsuba": {
        "otherwise": {"variant": "llvm_ad_rgb", "sampler": "multijitter", "rr_depth": 5, "one_sided_lights": False},
    },
    "cycles": {
        "otherwise": {"variant": "CPU", "sampler": "TABULATED_SOBOL", "rr_depth": 0, "emission_sampling": "AUTO",
                      "background_sampling": "AUTOMATIC", "light_tree": True, "guiding": False},
    },
    "luxcore": {
        "otherwise": {"variant": "PATHCPU", "sampler": "SOBOL", "rr_depth": 5, "light_strategy": "LOG_POWER",
                      "one_sided_lights": False},
    },
}
