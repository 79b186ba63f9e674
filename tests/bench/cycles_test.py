#!/usr/bin/env python3
"""Cycles as independent truth: scenes of few materials have the same mean radiance in both renderers. Skipped where
Blender or oiiotool is not installed. Argument: --chamferd PROGRAM."""
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


def scene_with(lights, materials):
    """A cube on a ground. `materials`: what both have beside their colours."""
    return {
        "meshes": [{"name": name, "file": f"{name}.obj", "rounding": False} for name in ("cube", "ground")],
        "materials": [{"name": "red", "base_color": [0.6, 0.1, 0.1], **materials}, {"name": "white", "base_color": 0.7, **materials}],
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
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        shutil.copy(SOURCE / "data/solids/cube.obj", self.folder)
        shutil.copy(SOURCE / "data/stage/ground.obj", self.folder)

    def ratios(self, lights, materials):
        """Mean of ours over mean of Cycles' picture, by channel. 350,000 samples: their noise is about 0.1 %."""
        scene, ours, theirs, job = (self.folder / name for name in ("a.scene.json", "ours.exr", "theirs.exr", "job.json"))
        scene.write_text(json.dumps(scene_with(lights, materials)))
        subprocess.run([programs.chamferd, "render", scene, "-o", ours, "--quiet",
                        *(f"--{key}={value}" for key, value in FRAME.items())], check=True)
        job.write_text(json.dumps({**FRAME, "scene": str(scene), "edges": "sharp", "picture": str(theirs),
                                   "result": str(self.folder / "result.json")}))
        blender = subprocess.run(["blender", "-b", "--factory-startup", "--python-exit-code", "3", "--python", cycles.SCRIPT,
                                  "--", job], capture_output=True, text=True, check=False)
        self.assertEqual(blender.returncode, 0, blender.stdout + blender.stderr)
        return [a / b for a, b in zip(means(ours), means(theirs))]

    def test_on_matt_surfaces(self):
        """Lambert's law in both: nothing but noise may differ."""
        for kind, lights in LIGHTS.items():
            with self.subTest(kind):
                for ratio in self.ratios(lights, {"specular": 0}):
                    self.assertAlmostEqual(ratio, 1, delta=0.005)

    def test_on_metal(self):
        """GGX with Schlick's Fresnel term in both."""
        for ratio in self.ratios(LIGHTS["sky"], {"roughness": 0.4, "metallic": 1}):
            self.assertAlmostEqual(ratio, 1, delta=0.01)

    def test_under_a_coat(self):
        """The base in Cycles leaves the coat the same share in all directions, ours more at grazing angles, at which much of
        the ground is seen here; Blender's own base is 10 % off."""
        for ratio in self.ratios(LIGHTS["sky"], {"roughness": 0.4}):
            self.assertAlmostEqual(ratio, 1, delta=0.06)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--chamferd", required=True)
    programs, rest = parser.parse_known_args()
    unittest.main(argv=[sys.argv[0], *rest])
