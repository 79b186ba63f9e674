"""The benchmark's scenes on disk: generated, rounded by chamferprep, each with a sharp twin.

The twin says "rounding": false of every mesh. Rendering the original with rounding=none would give the same pixels, but
would load the rounding all the same, and what the rounding costs in memory would not show."""
import hashlib
import json
import pathlib
import shutil
import subprocess

SOURCE = pathlib.Path(__file__).resolve().parents[3]

# In the order of the paper's table; the others follow.
STANDS_FOR = {"temple": "Scene 1", "gems": "Scene 2", "basalt": "Scene 3", "fortress": "Blocks"}
BUNDLED = ["still-life", "room", "dice", "blocks"]
GENERATED = [*STANDS_FOR, "wall"]
ALL = [*GENERATED, *BUNDLED]


class Failure(Exception):
    """Something that the caller of the command has to put right."""


def make(folder, names, chamferprep, node):
    """Writes the scenes called `names` below `folder` and returns name -> path."""
    generated, bundled = folder / "generated", folder / "bundled"
    _generate(generated, node)
    for part in ("solids", "bricks", "stage"):
        shutil.copytree(SOURCE / "data" / part, bundled / part, dirs_exist_ok=True)
    for name in BUNDLED:
        shutil.copy(SOURCE / f"data/{name}.scene.json", bundled)
    paths = {name: (generated if name in GENERATED else bundled) / f"{name}.scene.json" for name in names}
    for name, path in paths.items():
        scene = json.loads(path.read_text())
        for mesh in scene["meshes"]:
            radius = mesh.pop("radius", None)
            if radius and name in STANDS_FOR:
                _round(path.parent / mesh["file"], radius, chamferprep)
            mesh["rounding"] = False
        sharp_twin(path).write_text(json.dumps(scene))
    return paths


def _generate(folder, node):
    """Runs the generator unless it has run here and has not changed since."""
    sources = sorted((SOURCE / "data").rglob("*.mjs"))
    digest = hashlib.sha256(b"".join(path.read_bytes() for path in sources)).hexdigest()
    stamp = folder / "generator.sha256"
    if stamp.exists() and stamp.read_text() == digest:
        return
    folder.mkdir(parents=True, exist_ok=True)
    made = subprocess.run([node, SOURCE / "data/make.mjs", "--bench", folder], capture_output=True, text=True, check=False)
    if made.returncode != 0:
        raise Failure(f"the scenes could not be made with {node}: {made.stderr.strip()}")
    stamp.write_text(digest)


def _round(mesh, radius, chamferprep):
    done = subprocess.run([chamferprep, mesh, "--radius", str(radius), "--quiet"], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise Failure(done.stderr.strip())


def sharp_twin(path):
    return path.with_name(path.name.replace(".scene.json", ".sharp.scene.json"))
