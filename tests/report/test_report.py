"""Tests of the report in bench/report, run by ctest with a Python that has matplotlib and scipy."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
REPORT = Path(__file__).resolve().parents[2] / "bench" / "report"
sys.path.insert(0, str(REPORT))

import intervals  # noqa: E402


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


class Program(unittest.TestCase):
    def test_a_module_that_is_missing_is_named_with_its_package(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "scipy.py").write_text("raise ModuleNotFoundError(\"No module named 'scipy'\", name='scipy')")
            run = subprocess.run([sys.executable, REPORT / "report.py", folder], env={"PYTHONPATH": folder},
                                 capture_output=True, text=True)
        self.assertEqual(run.returncode, 1)
        self.assertEqual(run.stderr, "report.py: no module scipy; Debian: apt-get install python3-scipy\n")


if __name__ == "__main__":
    unittest.main()
