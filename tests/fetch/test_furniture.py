"""Tests of scenes/fetch's part that takes models out of a package, run by ctest; the package is made here."""

import os
import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

sys.dont_write_bytecode = True
SCENES = Path(__file__).resolve().parents[2] / "scenes"
sys.path.insert(0, str(SCENES))

import furniture  # noqa: E402

LIST = """\
name=Some catalogue
license=Creative Commons Attribution 3.0 license  Copyright \\u00a9 2020
id#1=one
name#1=Caf\\u00e9 chair
model#1=/some/chair/chair.obj
width#1=50
depth#1=100
height#1=25
creator#1=A. Maker
name#2=Closed
model#2=/some/closed/closed.obj
license#2=All rights reserved
name#3=Turned
model#3=/some/turned/turned.obj
width#3=200
depth#3=100
height#3=100
modelRotation#3=0 0 1 0 1 0 -1 0 0
license#3=Public domain
"""
CHAIR = "mtllib chair.mtl\nv 10 5 -2\nv 12 6 2 0.5 0.5 0.5\nv 10 5 2\nvt 0 1\nvn 0 1 0\nusemtl a\nf 1/1/1 2/1/1 3/1/1\n"


class Furniture(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder, self.out = Path(folder.name), Path(folder.name) / "out"
        with zipfile.ZipFile(self.folder / "Some.sh3f", "w") as archive:
            archive.writestr("PluginFurnitureCatalog.properties", LIST)
            archive.writestr("some/chair/chair.obj", CHAIR)
            archive.writestr("some/chair/chair.mtl", "newmtl a\n")
            archive.writestr("some/chairs/other.obj", "")
            archive.writestr("some/closed/closed.obj", CHAIR)
            archive.writestr("some/turned/turned.obj", "v 0 0 0\nv 1 1 2\nvn 1 0 0\n")

    def fetch(self, *names):
        return furniture.fetch_models(list(names), self.folder, self.out, "Models of a test.")

    def test_a_model_is_written_in_metres_on_the_ground_with_the_files_beside_it(self):
        self.fetch("Some/some/chair/chair.obj")
        obj = (self.out / "Some/some/chair/chair.obj").read_text()
        self.assertEqual(obj, "mtllib chair.mtl\nv -0.25 0 -0.5\nv 0.25 0.25 0.5\nv -0.25 0 0.5\nvt 0 1\nvn 0 1 0\n"
                              "usemtl a\nf 1/1/1 2/1/1 3/1/1\n")
        self.assertEqual((self.out / "Some/some/chair/chair.mtl").read_text(), "newmtl a\n")
        self.assertFalse((self.out / "Some/some/chairs").exists())

    def test_a_model_is_turned_as_its_catalogue_says(self):
        self.fetch("Some/some/turned/turned.obj")
        self.assertEqual((self.out / "Some/some/turned/turned.obj").read_text(),
                         "v -1 0 0.5\nv 1 1 -0.5\nvn 0 0 -1\n")

    def test_credits_name_model_author_and_licence(self):
        self.fetch("Some/some/chair/chair.obj", "Some/some/turned/turned.obj")
        credits = (self.out / "CREDITS.txt").read_text(encoding="utf-8")
        self.assertIn("Some/some/chair/chair.obj: Café chair, by A. Maker; Creative Commons Attribution 3.0", credits)
        self.assertIn("Some/some/turned/turned.obj: Turned, by an unnamed author; Public domain", credits)

    def test_a_model_under_another_licence_is_refused(self):
        with self.assertRaisesRegex(furniture.FetchError, "licence.*All rights reserved"):
            self.fetch("Some/some/closed/closed.obj")

    def test_a_model_that_is_not_there_is_named(self):
        with self.assertRaisesRegex(furniture.FetchError, "no model Some/some/table.obj"):
            self.fetch("Some/some/table.obj")

    def test_what_is_there_is_left(self):
        self.fetch("Some/some/chair/chair.obj")
        (self.folder / "Some.sh3f").unlink()
        self.assertIn("already there", self.fetch("Some/some/chair/chair.obj"))
        with self.assertRaisesRegex(furniture.FetchError, "neither"):
            self.fetch("Some/some/chair/chair.obj", "Some/some/turned/turned.obj")

    def test_a_file_of_the_archive_never_lands_elsewhere(self):
        with zipfile.ZipFile(self.folder / "Some.sh3f", "a") as archive:
            archive.writestr("some/chair/../../../../evil", "")
        with self.assertRaisesRegex(furniture.FetchError, "elsewhere"):
            self.fetch("Some/some/chair/chair.obj")

    def test_without_the_package_and_apt_one_line_says_what_to_do(self):
        if furniture.INSTALLED.is_dir():
            self.skipTest("the package is installed")
        run = subprocess.run([sys.executable, SCENES / "fetch", "town", "--out", self.out],
                             capture_output=True, text=True, env={**os.environ, "PATH": ""})
        self.assertEqual(run.returncode, 1)
        self.assertRegex(run.stderr, r"^scenes/fetch: town: there is no apt-get.*scenes/fetch town --from FOLDER`\n$")

    def test_the_town_names_its_models_once_each(self):
        names = furniture.models_named((SCENES / "town/town.toml").read_text(encoding="utf-8"), "../models/town")
        self.assertGreater(len(names), 50)
        self.assertIn("Scopia/scopia/acacia/acacia.obj", names)
        self.assertEqual(len(names), len(set(names)))


if __name__ == "__main__":
    unittest.main()
