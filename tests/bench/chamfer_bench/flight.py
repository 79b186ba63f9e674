"""A camera flight towards rounded objects: what the rounding costs over the share of rays that it affects (the paper's
Fig. 11)."""
import dataclasses
import json
import statistics

from . import plots
from .machine import describe
from .render import arguments, measure


def cameras(camera, steps, far, near):
    """`steps` cameras along the line from the scene's target through its eye, from `far` to `near` times their distance, in
    equal ratios."""
    eye, target = camera["eye"], camera["target"]
    for i in range(steps):
        share = i / max(1, steps - 1)
        factor = far * (near / far) ** share
        yield factor, {"eye": [t + (e - t) * factor for e, t in zip(eye, target)], "target": target}


def run(context, scene, roundings, steps, rounds, far, near, setting):
    """Measures, prints and writes flight.json and flight.svg."""
    path = context.scene(scene)
    views = list(cameras(json.loads(path.read_text())["camera"], steps, far, near))
    measured, refused = {}, {}
    for turn in range(rounds):
        for step, (factor, camera) in enumerate(views):
            for rounding in ["none", *roundings]:
                if rounding in refused:
                    continue
                picture = context.picture(f"flight-{step}", rounding)
                command = arguments(context.chamferd, path, rounding, setting, picture, camera)
                what = f"flight round {turn} {scene} {factor:.6g} {rounding} {setting}"
                result = context.log.get(what, lambda: measure(command))
                if "refused" in result:
                    refused[rounding] = result["refused"]
                    context.say(f"{rounding} is left out: {result['refused']}")
                    continue
                measured.setdefault((step, rounding), []).append(result)
                context.say(f"round {turn + 1}/{rounds}  distance {factor:6.3f}  {rounding:<9} {result['seconds']:8.2f} s")
    roundings = [r for r in roundings if r not in refused]
    points = []
    for step, (factor, camera) in enumerate(views):
        none = measured[step, "none"]
        point = {"distance": factor, "camera": camera, "seconds_none": statistics.median(r["seconds"] for r in none)}
        point["rounded_share"] = measured[step, "analytic"][0]["rounded_share"]
        point["time_ratio"] = {
            rounding: statistics.median(a["seconds"] / b["seconds"] for a, b in zip(measured[step, rounding], none))
            for rounding in roundings}
        points.append(point)
    slopes = {rounding: _slope([(p["rounded_share"], p["time_ratio"][rounding] - 1) for p in points])
              for rounding in roundings}
    print(_text(scene, points, roundings, slopes))
    result = {"what": "flight", "scene": scene, "machine": describe(), "setting": dataclasses.asdict(setting), "points": points,
              "cost_per_share": slopes}
    context.write("flight.json", json.dumps(result, indent=2) + "\n")
    plots.flight(context.output / "flight.svg", points, roundings)
    return points


def _slope(pairs):
    """Of the line through the origin that fits best: relative cost per share of affected rays."""
    square = sum(x * x for x, _ in pairs)
    return sum(x * y for x, y in pairs) / square if square else 0.0


def _text(scene, points, roundings, slopes):
    lines = ["", f"{scene}: cost over the share of camera and bounce rays on roundings",
             f"{'distance':>9} {'rounded rays':>13} {'none s':>8}" + "".join(f" {r:>10}" for r in roundings)]
    for p in points:
        lines.append(f"{p['distance']:>9.3f} {100 * p['rounded_share']:>11.2f} % {p['seconds_none']:>8.2f}" +
                     "".join(f" {100 * (p['time_ratio'][r] - 1):>+8.1f} %" for r in roundings))
    lines.append(" " * 15 + "cost when all are" + "".join(f" {100 * slopes[r]:>+8.1f} %" for r in roundings))
    return "\n".join(lines)
