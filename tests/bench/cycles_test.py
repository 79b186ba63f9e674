#!/usr/bin/env python3
"""Cycles as independent truth: a matt scene under each kind of light has the same mean radiance in both renderers. Skipped
where Blender or oiiotool is not installed. Argument: --chamferd PROGRAM."""
import argparse
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

from chamfer_bench import cycles

SOURCE = pathlib.Path(__file__).resolve().parents[2]
DARK = {"type": "environment", "color": 0}
LIGHTS = {
    "area": [{"type": "area", "center": [-2, -1, 3], "u": [0.5, 0, 0], "v": [0, 0.5, 0.2], "emission": [15, 14, 12]}, DARK],
    "directional": [{"type": "directional", "direction": [0.6, 0.5, -0.6], "irradiance": [3, 2.5, 2],
                     "angular_diameter_degrees": 2}, DARK],
    "sky": [{"type": "sky", "zenith": [0.2, 0.3, 0.6], "horizon": [0.6, 0.5, 0.4], "ground": [0.1, 0.2, 0.1]}],
}
FRAME = {"width": 80, "height": 45, "samples": 96, "bounces": 4, "threads": 2}
programs = None


def matt_scene(lights):
    """A red cube on a white ground, both without coat, so that both renderers have Lambert's law."""
    return {
        "meshes": [{"name": "cube", "file": "cube.obj", "rounding": False}, {"name": "ground", "file": "ground.obj", "rounding": False}],
        "materials": [{"name": "red", "base_color": [0.6, 0.1, 0.1], "specular": 0}, {"name": "white", "base_color": 0.7, "specular": 0}],
        "instances": [{"mesh": "cube", "material": "red", "translate": [0, 0, 0.5], "rotate": {"axis": [0, 0, 1], "degrees": 20}},
                      {"mesh": "ground", "material": "white"}],
        "lights": lights,
        "camera": {"eye": [3, -4, 3], "target": [0, 0, 0.4], "up": [0, 0, 1], "vfov_degrees": 40},
    }


def means(picture):
    text = subprocess.run(["oiiotool", "--stats", picture], capture_output=True, text=True, check=True).stdout
    line = next(line for line in text.splitlines() if "Stats Avg" in line)
    return [float(x) for x in line.split(":")[1].split()[:3]]


@unittest.skipUnless(shutil.which("blender") and shutil.which("oiiotool"), "needs blender and oiiotool (Debian: blender, openimageio-tools)")
class SameLight(unittest.TestCase):
    def test_in_both_renderers(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            shutil.copy(SOURCE / "data/solids/cube.obj", folder)
            shutil.copy(SOURCE / "data/stage/ground.obj", folder)
            for kind, lights in LIGHTS.items():
                with self.subTest(kind):
                    scene = folder / f"{kind}.scene.json"
                    scene.write_text(json.dumps(matt_scene(lights)))
                    ours, theirs, job = folder / "ours.exr", folder / "theirs.exr", folder / "job.json"
                    subprocess.run([programs.chamferd, "render", scene, "-o", ours, "--quiet",
                                    *(f"--{key}={value}" for key, value in FRAME.items())], check=True)
                    job.write_text(json.dumps({**FRAME, "scene": str(scene), "edges": "sharp", "picture": str(theirs),
                                               "result": str(folder / "result.json")}))
                    blender = subprocess.run(["blender", "-b", "--factory-startup", "--python-exit-code", "3", "--python",
                                              cycles.SCRIPT, "--", job], capture_output=True, text=True, check=False)
                    self.assertEqual(blender.returncode, 0, blender.stdout + blender.stderr)
                    for a, b in zip(means(ours), means(theirs)):
                        # Means of 350,000 samples: their noise is about 0.1 %, a wrong factor of a light is not.
                        self.assertAlmostEqual(a / b, 1, delta=0.005)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--chamferd", required=True)
    programs, rest = parser.parse_known_args()
    unittest.main(argv=[sys.argv[0], *rest])
