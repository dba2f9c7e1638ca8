"""Tests of the report in bench/report, run by ctest with a Python that has matplotlib and scipy."""

import json
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
REPORT = Path(__file__).resolve().parents[2] / "bench" / "report"
sys.path.insert(0, str(REPORT))

import numpy  # noqa: E402
from matplotlib.image import imsave  # noqa: E402

import answers  # noqa: E402
import difference_charts  # noqa: E402
import intervals  # noqa: E402
import rays_charts  # noqa: E402
import readme  # noqa: E402
import render_charts  # noqa: E402
import report  # noqa: E402
import rows  # noqa: E402
import scale_charts  # noqa: E402
import stability_charts  # noqa: E402
import style  # noqa: E402

MACHINE = {"cpu": "a", "threads": 2}


def spread(median, by=0.1):
    return {"median": median, "min": median * (1.0 - by), "max": median * (1.0 + by)}


def rays_row(accel, kind, speed, wrong=0, batch=None, scene="box", **fields):
    row = {"suite": "rays", "scene": scene, "rays": kind, "accel": accel, "threads": 1, "triangles": 12, "spheres": 0,
           "build_seconds": 0.5, "build_seconds_min": 0.4, "build_seconds_max": 0.6, "bytes": 1200, "runs": 3,
           "mrays_per_second": spread(speed), "rays_checked": 20000, "wrong": wrong, "wrong_batch": wrong, **fields}
    return {**row, "mrays_per_second_batch": spread(batch)} if batch else row


def picture_row(accel, spp, seconds, relmse, **fields):
    return {"suite": "render", "scene": "box", "accel": accel, "integrator": "path", "sampler": "sobol", "threads": 2,
            "width": 8, "height": 8, "spp": spp, "seconds": seconds, "seconds_min": 0.9 * seconds,
            "seconds_max": 1.1 * seconds, "relmse": relmse, "relmse_error": 0.01 * relmse, "reference_relmse": 1e-4,
            "mean_ratio": 1.0, "mean_ratio_error": 0.001, **fields}


def target_row(accel, seconds, extrapolated=False, **fields):
    return {"suite": "render", "scene": "box", "accel": accel, "integrator": "path", "sampler": "sobol",
            "question": "time to error", "width": 8, "target_relmse": 0.01, "relmse": 0.01, "seconds": seconds,
            "extrapolated": extrapolated, **fields}


def scale_row(accel, threads, speed, build, **fields):
    return {"suite": "scale", "scene": "sphere", "accel": accel, "threads": threads, "triangles": 1000, "spheres": 0,
            "build_seconds": build, "build_seconds_min": 0.9 * build, "build_seconds_max": 1.1 * build, "bytes": 1200,
            "mrays_per_second": spread(speed), "mrays_per_second_wall": spread(speed), "rays_checked": 100, "wrong": 0,
            **fields}


def stability_row(value, failures, trials=20000, **fields):
    return {"suite": "stability", "scene": "edges", "case": 5, "accel": "bvh", "queries": "single", "theme": "leaks",
            "title": "To edges", "fails": "the ray goes through", "swept": "radius", "value": value,
            "holds": value < 10.0, "trials": trials, "failures": failures, **fields}


def results_of(*fields):
    for row in fields:
        assert rows.fault(row) == "", rows.fault(row)
    return {"machine": MACHINE, "rows": [rows.Row(f"rows[{i}]", row) for i, row in enumerate(fields)],
            "runs": [{"suite": "rays", "command": "raylab-bench rays", "date": "2026-01-01T00:00:00Z"}]}


def page_of(*fields):
    """The text of the page that report.py makes of the rows."""
    with tempfile.TemporaryDirectory() as folder:
        results = {**results_of(*fields), "rows": list(fields)}
        (Path(folder) / "results.json").write_text(json.dumps(results))
        subprocess.run([sys.executable, REPORT / "report.py", folder], check=True, stdout=subprocess.DEVNULL)
        return (Path(folder) / "index.html").read_text(encoding="utf-8")


def every_chart(results):
    """(name, figure) of all charts, wide and narrow."""
    for narrow in (False, True):
        for chart in report.charts_of(results, Path()):
            style.narrow = narrow
            yield chart.name, chart.draw()
            style.narrow = False


KINDS = ["primary", "diffuse", "edge", "vertex"]
SOME_OF_ALL = [
    *(rays_row("bvh", kind, 5.0, batch=9.0, intersector="watertight") for kind in KINDS),
    *(rays_row("embree", kind, 4.0, wrong=5 if kind == "edge" else 0) for kind in KINDS),
    rays_row("bvh", "diffuse", 5.0, scene="dragon"),
    picture_row("bvh", 4, 0.1, 0.04), picture_row("bvh", 16, 0.4, 0.02), picture_row("embree", 4, 0.2, 0.04),
    target_row("bvh", 0.8, extrapolated=True), target_row("embree", 0.7),
    target_row("mitsuba", 2.0, renderer="Mitsuba"),
    scale_row("bvh", 1, 4.0, 1.0), scale_row("bvh", 2, 7.0, 0.6), scale_row("embree", 1, 4.1, 1.0),
]


class Intervals(unittest.TestCase):
    def test_none_of_20000_is_an_interval_and_not_zero(self):
        low, high = intervals.proportion(0, 20000)
        self.assertEqual(low, 0.0)
        self.assertAlmostEqual(1e6 * high, 184.43, places=1)  # 1 - 0.025^(1/20000)

    def test_few_repeats_hold_the_median_less_surely(self):
        self.assertAlmostEqual(intervals.median_coverage(3), 0.75)
        self.assertGreater(intervals.median_coverage(6), 0.95)

    def test_many_rows_are_judged_by_holm(self):
        for adjusted, expected in zip(intervals.holm([0.01, 0.04, 0.03]), [0.03, 0.06, 0.06]):
            self.assertAlmostEqual(adjusted, expected)
        # Each of five such rows alone would pass for worse, together they need more.
        self.assertEqual(intervals.as_few([(0, 20000)] + [(7, 20000)] * 5), [True] + [True] * 5)
        self.assertEqual(intervals.as_few([(0, 20000), (7, 20000)]), [True, False])


class Style(unittest.TestCase):
    def test_any_number_of_plugins_of_unknown_names_is_told_apart(self):
        looks = [style.look(f"plugin {i}", f"plugin {i}") for i in range(200)]
        self.assertEqual(len({(look.color, look.marker) for look in looks}), 200)
        self.assertEqual(len({look.color for look in looks[:len(style.SPARE_COLORS)]}), len(style.SPARE_COLORS))
        few = {style.look(name, name).color for name in ("bvh", "embree", "rtiow", "list", "embree-robust")}
        self.assertFalse(few & {look.color for look in looks[:4]})

    def test_a_way_looks_the_same_in_every_chart(self):
        self.assertEqual(style.look_of({"accel": "bvh"}), render_charts.look_of({"accel": "bvh", "sampler": "sobol"}))

    def test_the_page_in_dark_colours_has_one_for_each_that_charts_use(self):
        used = {*style.COLORS.values(), *style.SPARE_COLORS, *style.SERIES}
        self.assertLessEqual(used, set(style.DARK))
        self.assertEqual(len(set(style.DARK.values())), len(style.DARK))

    def test_names_at_the_ends_of_lines_stand_apart_and_in_order(self):
        apart = style.spread([5.0, 1.0, 1.1, 5.05, 9.0], 1.0)
        ordered = sorted(apart)
        self.assertTrue(all(b - a > 0.999 for a, b in zip(ordered, ordered[1:])))
        self.assertEqual([apart.index(y) for y in ordered], [1, 2, 0, 3, 4])
        for name, figure in every_chart(results_of(*SOME_OF_ALL)):
            for axis in figure.axes:
                ys = sorted(axis.transData.transform((1.0, label.get_position()[1]))[1]
                            for label in getattr(axis, "end_labels", []))
                self.assertTrue(all(b - a > 9.0 for a, b in zip(ys, ys[1:])), name)
            style.plt.close(figure)

    def test_logarithmic_axes_have_a_few_round_numbers_whatever_their_limits(self):
        self.assertEqual(style.log_ticks(0.02, 0.045, 5), [0.02, 0.03, 0.04])
        self.assertEqual(style.log_ticks(0.5, 30.0, 5), [1.0, 3.0, 10.0, 30.0])
        for low, high in ((0.02, 0.03), (1.0, 9.0), (0.1, 1e9), (1e-12, 1.0)):
            ticks = style.log_ticks(low, high, 5)
            self.assertTrue(1 <= len(ticks) <= 5, ticks)

    def test_no_bars_start_from_nowhere_on_a_logarithmic_axis(self):
        for name, figure in every_chart(results_of(*SOME_OF_ALL)):
            for axis in figure.axes:
                bars = [c for c in axis.containers if isinstance(c, style.matplotlib.container.BarContainer)]
                self.assertFalse(bars and "log" in (axis.get_xscale(), axis.get_yscale()), name)
            style.plt.close(figure)

    def test_figures_for_a_telephone_are_as_wide_as_it(self):
        style.narrow = True
        figure, _ = style.panels(5, 5)
        style.narrow = False
        self.assertEqual(figure.get_figwidth(), 4.0)
        style.plt.close(figure)


class Page(unittest.TestCase):
    page = page_of(*SOME_OF_ALL)

    def test_it_opens_with_the_table_and_ends_with_the_commands(self):
        places = [self.page.index(text) for text in ("<table>", "<svg", "raylab-bench rays")]
        self.assertEqual(places, sorted(places))
        self.assertIn(">below 184<", self.page)
        self.assertIn("0 of 20,000", self.page)
        self.assertIn("81.2–583", self.page)  # Clopper and Pearson's interval of 5 of 20,000
        self.assertIn("≈ 0.8", self.page)
        self.assertIn("extrapolated", self.page)

    def test_the_dragon_comes_first_and_other_scenes_need_no_script(self):
        self.assertIn("<h2>dragon", self.page)
        self.assertIn("<details><summary>box", self.page)
        self.assertEqual(self.page.count("<script>"), 1)

    def test_a_cell_without_a_measurement_says_why(self):
        self.assertIn("no row holds its speed in batches.", self.page)
        self.assertIn("no shadow rays of this scene were measured.", self.page)
        self.assertIn("no whole pictures of this scene were measured.", self.page)

    def test_it_needs_no_other_file(self):
        self.assertNotIn("<img", self.page)
        self.assertNotIn("<link", self.page)
        self.assertEqual(set(re.findall(r'(?:src|href)="([^#"]+)', self.page)), {"results.csv", "results.json"})
        ids = re.findall(r' id="([^"]+)"', self.page)
        self.assertEqual(len(ids), len(set(ids)))
        self.assertLessEqual(set(re.findall(r'(?:url\(|href=")#([^")]+)', self.page)), set(ids))

    def test_it_has_both_schemes_and_no_colour_outside_them(self):
        self.assertIn("prefers-color-scheme: dark", self.page)
        rules = re.findall(r"\.s\d+ \{[^}]*\}", self.page)
        self.assertGreater(len(rules), 10)
        self.assertFalse([rule for rule in rules if "#" in rule])

    def test_numbers_in_charts_are_left_as_they_are(self):
        text = '<svg width="10.0pt" height="5.0pt"><text x="1.23456">0.00123</text></svg>'
        self.assertIn('x="1.23">0.00123<', report.page.svg.inlined(text, "a", "b"))

    def test_words_are_the_same_everywhere(self):
        self.assertNotIn("side by side", self.page)
        self.assertNotIn("wrong hit", self.page)


class Sentences(unittest.TestCase):
    def test_the_summary_names_the_fastest_without_a_wrong_answer(self):
        rows_of_box = [rays_row("a", "diffuse", 5.0), rays_row("b", "diffuse", 9.0, wrong=3),
                       rays_row("c", "diffuse", 4.0)]
        says = answers.summary("box", results_of(*rows_of_box)["rows"])
        self.assertIn("2 of 3 ways", says)
        self.assertIn("the fastest of them is a: 5 million", says)
        self.assertIn("b, wrong on 3 of 20,000, is the fastest of all", says)
        rows_of_box[0]["wrong"] = rows_of_box[2]["wrong"] = 7
        self.assertIn("b the fewest, 3 of 20,000", answers.summary("box", results_of(*rows_of_box)["rows"]))

    def test_what_noise_hides_is_called_a_tie(self):
        close = [rays_row("a", "diffuse", 5.0), rays_row("b", "diffuse", 5.5, wrong=3)]
        self.assertIn("is as fast, within a tenth", answers.summary("box", results_of(*close)["rows"]))
        self.assertEqual(answers.as_fast([5.0, 8.2, 9.0]), [False, True, True])

    def test_the_pareto_line_holds_what_nothing_beats_in_both(self):
        self.assertEqual(rays_charts.front([(1, 5), (2, 6), (3, 2), (1, 7)]), [(1, 5), (3, 2)])
        says = rays_charts.on_the_line("box", results_of(rays_row("a", "diffuse", 5.0, batch=7.0),
                                                         rays_row("b", "diffuse", 9.0, wrong=3))["rows"])
        self.assertEqual(says, "box, on the Pareto line: a in batches (diffuse); b (diffuse). Not measured in "
                         "batches: b.")

    def test_whole_pictures_say_what_varies_and_what_ties(self):
        scenes = {"box": results_of(picture_row("bvh", 4, 1.0, 0.04), picture_row("embree", 4, 1.05, 0.04),
                                    picture_row("bvh", 4, 3.0, 0.04, sampler="independent"))["rows"]}
        self.assertIn("differ in accelerator, sampler; no row here varies triangle test", render_charts.varied(scenes))
        self.assertEqual(render_charts.cheapest(scenes, {}), "The least error for its time: on box bvh (not to be "
                         "told from embree), where bvh, independent takes 3 times as long for the same error.")

    def test_of_ways_that_took_turns_the_rounds_decide(self):
        def goal(accel, mean, low, high):
            return target_row(accel, 1.0, time_ratio={"mean": mean, "low": low, "high": high}, against="bvh", runs=4)
        scenes = {"box": results_of(picture_row("bvh", 4, 1.0, 0.04))["rows"]}
        goals = [target_row("bvh", 1.0), goal("embree", 1.05, 0.98, 1.2), goal("rtiow", 3.0, 2.5, 3.5)]
        self.assertEqual(render_charts.cheapest(scenes, {"box": results_of(*goals)["rows"]}),
                         "The least error for its time: on box bvh (not to be told from embree), where rtiow takes 3 "
                         "times as long for the same error.")
        self.assertTrue(answers.as_soon(goals[1], goals[0]))
        self.assertFalse(answers.as_soon(goals[2], goals[0]))

    def test_a_time_that_was_not_measured_is_hollow_and_said_to_be_so(self):
        targets = {"box": results_of(target_row("bvh", 0.8, extrapolated=True), target_row("embree", 0.7))["rows"]}
        self.assertIn("measured points: 1 of 2; extrapolated beyond the last: 1.", render_charts.reached(targets))
        figure = render_charts.time_to_error(results_of(), targets)
        faces = {line.get_label(): line.get_markerfacecolor() for line in figure.axes[0].lines}
        self.assertEqual(sorted(face == "none" for face in faces.values()), [False, True])
        style.plt.close(figure)

    def test_pictures_of_two_sizes_are_not_compared(self):
        of_both = results_of(target_row("bvh", 0.5), target_row("bvh", 9.0, width=16), rays_row("bvh", "diffuse", 5.0))
        self.assertEqual(list(render_charts.by_size(of_both["rows"][:2])), ["box at 8 pixels", "box at 16 pixels"])
        self.assertIn(">9<", answers.html(of_both).replace("<strong>", "").replace("</strong>", ""))


class Differences(unittest.TestCase):
    def test_a_pixel_that_hardly_differs_is_seen(self):
        row = {"suite": "render", "scene": "box", "accel": "bvh", "question": "difference", "against": "list",
               "width": 64, "spp": 4, "different_pixels": 1, "pixels": 64 * 64, "relmse": 1e-9,
               "picture": "difference.png"}
        picture = numpy.zeros((64, 64, 3))
        picture[10, 20, 0] = 1.0 / 255.0  # as dark as a pixel may be that is not black
        with tempfile.TemporaryDirectory() as folder:
            imsave(Path(folder) / "difference.png", picture)
            chart = next(c for c in difference_charts.charts(results_of(row), Path(folder)) if c.name == "where")
            figure = chart.draw()
        dots = [(tuple(dots.get_offsets()[0]), dots.get_sizes()[0]) for dots in figure.axes[0].collections
                if len(dots.get_offsets())]
        self.assertEqual(dots[0][0], (20.0, 10.0))
        self.assertGreater(dots[0][1] ** 0.5, 2.0)  # points across
        self.assertIn("amplifies it by 1,000", chart.reading)
        style.plt.close(figure)


class Threads(unittest.TestCase):
    def test_a_speedup_of_runs_that_were_not_paired_is_hollow_and_judged_by_its_interval(self):
        scenes = scale_charts.speedups(results_of(scale_row("bvh", 1, 4.0, 1.0), scale_row("bvh", 2, 12.0, 0.5)))
        (_, trace, paired, _), (_, build, _, _) = scenes["sphere, 1,000 triangles"]
        self.assertFalse(paired)
        self.assertEqual(trace["median"], 3.0)  # as it was measured
        self.assertAlmostEqual(trace["min"], 0.9 / 1.1 * 3.0)
        self.assertTrue(scale_charts.is_implausible(trace, 2))
        self.assertFalse(scale_charts.is_implausible(build, 2))
        says = scale_charts.says_threads(scenes)
        self.assertIn("Medians beyond the number of threads, which only noise can give: 1;", says)

    def test_paired_runs_are_taken_where_there_are_some(self):
        row = {"suite": "threads", "scene": "box", "accel": "bvh", "threads": 2, "processes": 1, "speedup": spread(1.9)}
        self.assertEqual(scale_charts.speedups(results_of(row))["box"][0][1:3], (spread(1.9), True))


class Stability(unittest.TestCase):
    def test_the_matrix_says_from_where_a_method_fails(self):
        def text(*failures):
            rows = [stability_row(10.0**i, count, 100) for i, count in enumerate(failures)]
            return stability_charts.where(rows).text

        self.assertEqual(text(0, 0, 0), "holds")
        self.assertEqual(text(0, 1, 7), "from 10")
        self.assertEqual(text(5, 1, 0), "to 10")
        self.assertEqual(text(5, 1, 9), "everywhere")
        self.assertEqual(text(0, 1, 0), "at 10")
        self.assertEqual(text(0, 1, 2, 0), "10–100")
        self.assertEqual(text(1, 0, 2), "1–100, not all")
        self.assertEqual(stability_charts.where([stability_row(1.0, 50, 100)]).below, "50%")

    def test_none_of_many_is_said_to_be_below_a_rate(self):
        cases = stability_charts.cases_of(results_of(*(stability_row(value, 0) for value in (1.0, 10.0))))
        self.assertEqual(stability_charts.says(cases),
                         "Nothing fails in 1 cases. 0 of 20,000 means below 184 in a million at 95%.")

    def test_batches_are_drawn_where_they_differ_alone(self):
        rows = [stability_row(value, 3, accel="embree") for value in (1.0, 10.0)]
        batches = [{**row, "queries": "batch", "failures": row["failures"] + (row["value"] > 1.0)} for row in rows]
        lines = {name for name, *_ in stability_charts.lines_of(
            stability_charts.cases_of(results_of(*rows, *batches))[5])}
        self.assertEqual(lines, {"embree", "embree batch"})
        same = [{**row, "queries": "batch"} for row in rows]
        lines = {name for name, *_ in stability_charts.lines_of(stability_charts.cases_of(results_of(*rows, *same))[5])}
        self.assertEqual(lines, {"embree"})

    def test_the_page_has_the_matrix_and_the_promises(self):
        page = page_of(*(stability_row(value, count, accel=accel) for accel, count in (("bvh", 0), ("embree", 12))
                         for value in (1.0, 10.0)))
        for part in ("Where accelerators fail", "What each method promises", "everywhere", "stability-leaks"):
            self.assertIn(part, page)


    def test_the_readme_says_from_where_methods_fail_and_in_how_many_cases(self):
        self.assertEqual(readme.stability_table(results_of(rays_row("bvh", "diffuse", 5.0))), "")
        table = readme.stability_table(results_of(*(
            stability_row(value, int(accel == "embree" and case == 9 and value > 1.0), case=case, accel=accel, **test)
            for case in readme.STABILITY_CASES for value in (1.0, 10.0)
            for accel, test in (("bvh", {"intersector": "watertight"}), ("embree", {})))))
        self.assertIn("from 10", table)
        self.assertIn("| 1 of 10 | 0 of 0 | 0 of 10 |", table)


class Program(unittest.TestCase):
    def test_results_of_a_later_version_are_refused_by_it(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "results.json"
            for version, code in ((2, 3), ("1", 3), (1, 0)):
                file.write_text(json.dumps({"version": version, **results_of(rays_row("bvh", "diffuse", 5.0))}))
                run = subprocess.run([sys.executable, REPORT / "report.py", folder], capture_output=True, text=True)
                self.assertEqual(run.returncode, code, run.stderr)
                if code:
                    self.assertEqual(run.stderr, f"report.py: {file}: its results are of format version {version}, "
                                                 "and this program reads 1\n")

    def test_a_module_that_is_missing_is_named_with_its_package(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "scipy.py").write_text("raise ModuleNotFoundError(name='scipy')")
            run = subprocess.run([sys.executable, REPORT / "report.py", folder], env={"PYTHONPATH": folder},
                                 capture_output=True, text=True)
        self.assertEqual(run.returncode, 1)
        self.assertEqual(run.stderr, "report.py: no module scipy; Debian: apt-get install python3-scipy\n")


if __name__ == "__main__":
    unittest.main()
