"""The paper's Table 1: every scene with every rounding, interleaved over several rounds."""
import dataclasses
import json
import statistics
import time

from . import plots
from .machine import describe
from .render import arguments, measure
from .scenes import STANDS_FOR

ROUNDINGS = ["none", "analytic", "mesh:1", "mesh:3", "mesh:5", "mesh:10", "bevel:4"]


def run(context, scenes, roundings, rounds, setting, deadline):
    """Measures, prints and writes table.json and table.svg; returns the rows."""
    if "none" not in roundings:
        roundings = ["none", *roundings]
    begin = time.monotonic()
    measured, refused = {}, {}
    for turn in range(rounds):
        for scene in scenes:
            # Each round begins with another variant: none always runs on a machine as warm as the others found it.
            order = roundings[turn % len(roundings):] + roundings[:turn % len(roundings)]
            for rounding in order:
                if (scene, rounding) in refused:
                    continue
                picture = context.picture(scene, rounding)
                command = arguments(context.chamferd, context.scene(scene), rounding, setting, picture)
                what = f"table round {turn} {scene} {rounding} {setting}"
                result = context.log.get(what, lambda: measure(command))
                if "refused" in result:
                    refused[scene, rounding] = result["refused"]
                    context.say(f"{scene} with {rounding} is left out: {result['refused']}")
                    continue
                measured.setdefault((scene, rounding), []).append(result)
                context.say(f"round {turn + 1}/{rounds}  {scene:<11} {rounding:<9} {result['seconds']:8.2f} s "
                            f"{result['peak_bytes'] / 2**20:8.1f} MiB")
        spent = time.monotonic() - begin
        if turn == 0 and rounds > 1:
            context.say(f"first round took {spent:.0f} s; all {rounds} will take about {spent * rounds / 60:.1f} min")
        if deadline and turn + 1 < rounds and spent * (turn + 2) / (turn + 1) > deadline:
            context.say(f"stopping after round {turn + 1}: another would pass the limit of {deadline:.0f} s")
            break
    rows = [_row(scene, rounding, measured) for scene in scenes for rounding in roundings if (scene, rounding) in measured]
    print(_text(rows))
    result = {"what": "Table 1", "machine": describe(), "setting": dataclasses.asdict(setting),
              "refused": [{"scene": s, "rounding": r, "why": why} for (s, r), why in refused.items()], "rows": rows}
    context.write("table.json", json.dumps(result, indent=2) + "\n")
    plots.table(context.output / "table.svg", rows)
    return rows


def _row(scene, rounding, measured):
    runs, none = measured[scene, rounding], measured[scene, "none"]
    ratios = [run["seconds"] / base["seconds"] for run, base in zip(runs, none)]  # of the same round
    return {
        "scene": scene,
        "stands_for": STANDS_FOR.get(scene),
        "rounding": rounding,
        "rounds": len(runs),
        "triangles": runs[0]["triangles"],
        "seconds": statistics.median(run["seconds"] for run in runs),
        "seconds_all": [run["seconds"] for run in runs],
        "load_seconds": statistics.median(run["load_seconds"] for run in runs),
        "time_ratio": statistics.median(ratios),
        "time_ratio_range": [min(ratios), max(ratios)],
        "peak_bytes": _peak(runs),
        "memory_ratio": _peak(runs) / _peak(none),
        "rounded_share": runs[0]["rounded_share"],
        "samples_per_second": statistics.median(run["samples"] / run["seconds"] for run in runs),
        "load_average": max(run["load_average"] for run in runs),
    }


def _peak(runs):
    return statistics.median(run["peak_bytes"] for run in runs)


def _text(rows):
    lines = ["", f"{'scene':<22} {'rounding':<9} {'triangles':>10} {'load s':>7} {'time s':>9} {'ratio':>7} {'(range)':>15} "
                 f"{'memory MiB':>11} {'ratio':>7} {'rounded rays':>13}"]
    for i, r in enumerate(rows):
        name = ""
        if i == 0 or rows[i - 1]["scene"] != r["scene"]:
            name = r["scene"] + (f" ({r['stands_for']})" if r["stands_for"] else "")
        low, high = r["time_ratio_range"]
        share = f"{100 * r['rounded_share']:.2f} %" if r["rounding"] == "analytic" else "-"
        lines.append(f"{name:<22} {r['rounding']:<9} {r['triangles']:>10,} {r['load_seconds']:>7.2f} {r['seconds']:>9.2f} "
                     f"{r['time_ratio']:>7.3f} {f'({low:.3f}-{high:.3f})':>15} {r['peak_bytes'] / 2**20:>11.1f} "
                     f"{r['memory_ratio']:>7.3f} {share:>13}")
    lines.append("time: rendering alone (load: reading and rounding), medians; ratio to none: median of the rounds' own "
                 "ratios; rounded rays: of camera and bounce rays")
    return "\n".join(lines)
