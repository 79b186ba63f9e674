"""The same scenes in Blender's Cycles: samples per second side by side, pictures side by side."""
import dataclasses
import json
import pathlib
import shutil
import statistics
import subprocess

from . import process
from .machine import describe
from .render import arguments, measure
from .scenes import Failure

SCRIPT = pathlib.Path(__file__).with_name("blender_scene.py")
# (ours, Cycles'): what is compared with what.
PAIRS = [("none", "sharp"), ("analytic", "bevel-node"), ("analytic", "bevel-modifier")]
PROBES = 4  # of the Bevel node, as in the paper
SEGMENTS = 4  # of the bevel modifier


def find_blender(given):
    """The program and its version; nothing where there is none."""
    program = shutil.which(given)
    if not program:
        print(f"skipped: {given} is not installed (Debian: apt-get install blender); name another with --blender")
        return None
    version = subprocess.run([program, "--version"], capture_output=True, text=True, check=False).stdout.split("\n")[0]
    return program, version


def run(context, blender, scenes, rounds, setting):
    """Measures, prints and writes cycles.json and the pictures; returns the rows."""
    program, version = blender
    measured = {}
    for turn in range(rounds):
        for scene in scenes:
            for what in ("none", "sharp", "analytic", "bevel-node", "bevel-modifier"):
                picture = context.output / "pictures" / f"{scene}-{what}.exr"
                if what in ("none", "analytic"):
                    command = arguments(context.chamferd, context.scene(scene), what, setting, picture)
                    job = lambda: _ours(measure(command))
                else:
                    job = lambda: _theirs(program, context, scene, what, setting, picture)
                result = context.log.get(f"cycles round {turn} {version} {scene} {what} {setting}", job)
                measured.setdefault((scene, what), []).append(result)
                who = "chamferd" if what in ("none", "analytic") else "Cycles"
                context.say(f"round {turn + 1}/{rounds}  {scene:<11} {who:<8} {what:<14} "
                            f" {result['samples_per_second'] * 1e-6:8.3f} million samples/s")
    rows = [_row(scene, ours, theirs, measured) for scene in scenes for ours, theirs in PAIRS]
    for scene in scenes:
        _side_by_side(context, scene, rows)
    print(_text(rows, version))
    result = {"what": "Cycles", "blender": version, "machine": describe(), "setting": dataclasses.asdict(setting),
              "bevel_node_probes": PROBES, "bevel_modifier_segments": SEGMENTS, "rows": rows}
    context.write("cycles.json", json.dumps(result, indent=2) + "\n")
    return rows


def _ours(result):
    if "refused" in result:
        raise Failure(result["refused"])
    return {**result, "samples_per_second": result["samples"] / result["seconds"]}


def _theirs(program, context, scene, edges, setting, picture):
    job, answer = context.output / "job.json", context.output / "answer.json"
    answer.unlink(missing_ok=True)
    job.write_text(json.dumps({"scene": str(context.scene(scene)), "edges": edges, "probes": PROBES, "segments": SEGMENTS,
                               **dataclasses.asdict(setting), "picture": str(picture), "result": str(answer)}))
    done = process.run([program, "-b", "--factory-startup", "--python-exit-code", "3", "--python", SCRIPT, "--", job])
    if done.status != 0 or not answer.exists():
        raise Failure(f"Blender ended with status {done.status}:\n{(done.stdout + done.stderr)[-2000:]}")
    return {**json.loads(answer.read_text()), "peak_bytes": done.peak_bytes}


def _row(scene, ours, theirs, measured):
    pairs = list(zip(measured[scene, ours], measured[scene, theirs]))
    rate = lambda what: statistics.median(run["samples_per_second"] for run in measured[scene, what])
    ratios = [a["samples_per_second"] / b["samples_per_second"] for a, b in pairs]
    return {
        "scene": scene,
        "ours": ours,
        "cycles": theirs,
        "ours_samples_per_second": rate(ours),
        "cycles_samples_per_second": rate(theirs),
        "ratio": statistics.median(ratios),
        "ratio_range": [min(ratios), max(ratios)],
        "ours_peak_bytes": measured[scene, ours][0]["peak_bytes"],
        "cycles_peak_bytes": measured[scene, theirs][0]["peak_bytes"],
    }


def _text(rows, version):
    lines = ["", f"chamferd and {version}'s Cycles, million samples per second; rendering alone",
             f"{'scene':<12} {'chamferd':<10} {'M/s':>7}   {'Cycles':<15} {'M/s':>7}   {'ratio':>6} {'(range)':>13} "
             f"{'brightness':>11}"]
    for r in rows:
        low, high = r["ratio_range"]
        light = f"{r['brightness_ratio']:.3f}" if "brightness_ratio" in r else "-"
        lines.append(f"{r['scene']:<12} {r['ours']:<10} {r['ours_samples_per_second'] * 1e-6:>7.3f}   {r['cycles']:<15} "
                     f"{r['cycles_samples_per_second'] * 1e-6:>7.3f}   {r['ratio']:>6.2f} "
                     f"{f'({low:.2f}-{high:.2f})':>13} {light:>11}")
    lines.append("brightness: mean of Cycles' linear picture over ours")
    return "\n".join(lines)


# ---------------------------------------------------------------------------------------------------- pictures


def _tool(*arguments_):
    done = subprocess.run(["oiiotool", *map(str, arguments_)], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise Failure(f"oiiotool: {(done.stderr or done.stdout).strip()}")
    return done.stdout


def _mean(picture):
    line = next(line for line in _tool("--stats", picture).splitlines() if "Stats Avg" in line)
    return sum(float(x) for x in line.split(":")[1].split()[:3]) / 3


def _side_by_side(context, scene, rows):
    """PNGs of both, the same exposure and plain sRGB; sets the rows' "brightness_ratio"."""
    if not shutil.which("oiiotool"):
        context.say("no pictures side by side: oiiotool is not installed (Debian: openimageio-tools)")
        return
    folder = context.output / "pictures"
    for row in rows:
        if row["scene"] == scene:
            theirs, ours = (_mean(folder / f"{scene}-{row[who]}.exr") for who in ("cycles", "ours"))
            row["brightness_ratio"] = theirs / ours
    for name, parts in (("sharp", ["none", "sharp"]), ("rounded", ["analytic", "bevel-node", "bevel-modifier"])):
        target = context.output / f"{scene}-{name}.png"
        pictures = [word for part in parts for word in (folder / f"{scene}-{part}.exr", "--ch", "R,G,B")]
        _tool(*pictures, "--mosaic:pad=8", f"{len(parts)}x1", "--colorconvert", "linear", "sRGB", "-d", "uint8", "-o", target)
        context.say(f"picture: {target} ({' | '.join(parts)})")
