#!/usr/bin/env python3
"""Runs the benchmark's commands on pictures of a few pixels: they end, go on after an interruption, and their figures fit
together. Arguments: --chamferd PROGRAM --chamferprep PROGRAM --node PROGRAM."""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

BENCH = pathlib.Path(__file__).with_name("bench.py")
programs = None


class Commands(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls._folder = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls._folder.name)

    @classmethod
    def tearDownClass(cls):
        cls._folder.cleanup()

    def bench(self, command, *options):
        run = subprocess.run([sys.executable, BENCH, command, "-o", self.folder, "--chamferd", programs.chamferd, "--chamferprep",
                              programs.chamferprep, "--node", programs.node, "--width", "48", "--height", "27", "--samples", "2",
                              *options], capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, 0, run.stderr)
        return run.stdout, json.loads((self.folder / f"{command}.json").read_text())

    def test_table(self):
        options = ("--scenes", "temple", "gems", "--roundings", "none", "analytic", "--rounds", "2")
        text, result = self.bench("table", *options)
        rows = {(row["scene"], row["rounding"]): row for row in result["rows"]}
        self.assertEqual(len(rows), 4)
        for (scene, rounding), row in rows.items():
            self.assertEqual(row["rounds"], 2)
            self.assertGreater(row["seconds"], 0)
            self.assertGreater(row["peak_bytes"], row["triangles"] * 12, "three indices a triangle at least")
            self.assertIn(scene, text)
            if rounding == "none":
                self.assertEqual((row["time_ratio"], row["memory_ratio"], row["rounded_share"]), (1, 1, 0))
            else:
                self.assertAlmostEqual(row["memory_ratio"], row["peak_bytes"] / rows[scene, "none"]["peak_bytes"])
                self.assertTrue(row["time_ratio_range"][0] <= row["time_ratio"] <= row["time_ratio_range"][1])
        # What the scenes are made for: few rays on the temple's roundings, over a quarter on the gems'.
        self.assertTrue(0.05 < rows["temple", "analytic"]["rounded_share"] < 0.1)
        self.assertTrue(0.26 < rows["gems", "analytic"]["rounded_share"] < 0.32)

        log = (self.folder / "runs.jsonl").read_bytes()
        (self.folder / "runs.jsonl").write_bytes(log + b'{"key": "cut o')
        self.bench("table", *options)
        self.assertEqual((self.folder / "runs.jsonl").read_bytes(), log + b'{"key": "cut o', "nothing was measured again")

    def test_a_wall_of_a_million_bricks_loads_in_seconds(self):
        _, result = self.bench("table", "--scenes", "wall", "--roundings", "none", "analytic", "--rounds", "1")
        for row in result["rows"]:
            self.assertEqual(row["triangles"], 12 * 1_000_000 + 12)
            self.assertLess(row["load_seconds"], 30, "on whatever machine and beside whatever else")
        self.assertGreater(result["rows"][1]["rounded_share"], 0.05)

    def test_flight(self):
        _, result = self.bench("flight", "--steps", "3", "--rounds", "1", "--roundings", "analytic")
        shares = [point["rounded_share"] for point in result["points"]]
        self.assertEqual(len(shares), 3)
        self.assertLess(shares[0], 0.15, "far away there is mostly ground")
        self.assertGreater(max(shares), shares[0])


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--chamferd", required=True)
    parser.add_argument("--chamferprep", required=True)
    parser.add_argument("--node", default="node")
    programs, rest = parser.parse_known_args()
    unittest.main(argv=[sys.argv[0], *rest])
