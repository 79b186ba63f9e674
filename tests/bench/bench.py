#!/usr/bin/env python3
"""Benchmarks of chamferd on scenes that stand in for those of the paper (data/README.md describes them).

  bench.py table    every scene with every rounding: time, memory, ratios to none (the paper's Table 1)
  bench.py flight   a camera flight towards rounded objects: cost over the share of affected rays (its Fig. 11)
  bench.py cycles   the same scenes in Blender's Cycles: samples per second and pictures side by side

Every measurement is a process of its own, the variants are interleaved over several rounds, and medians are printed. Results go
to a folder (-o); a command that was interrupted goes on where it stopped, when it is given again. Programs are taken from
build/release unless told otherwise. For figures that mean something, leave the machine to the benchmark alone."""
import argparse
import os
import pathlib
import sys

from chamfer_bench import cycles, flight, scenes, table
from chamfer_bench.render import RunLog, Setting

SOURCE = scenes.SOURCE


class Context:
    """Where things are: programs, scenes, results."""

    def __init__(self, options, names):
        self.output = pathlib.Path(options.output).resolve()
        self.output.mkdir(parents=True, exist_ok=True)
        self.chamferd = _program(options.chamferd, "build/release/server/chamferd")
        chamferprep = _program(options.chamferprep, "build/release/preprocess/chamferprep")
        self._scenes = scenes.make(self.output / "scenes", names, chamferprep, options.node)
        self.log = RunLog(self.output / "runs.jsonl", self.chamferd, options.fresh)
        (self.output / "pictures").mkdir(exist_ok=True)

    def scene(self, name):
        return self._scenes[name]

    def picture(self, name, rounding):
        return self.output / "pictures" / f"{name}-{rounding.replace(':', '')}.png"

    def write(self, name, text):
        (self.output / name).write_text(text)
        self.say(f"written: {self.output / name}")

    @staticmethod
    def say(text):
        print(text, flush=True)


def _program(given, usual):
    path = pathlib.Path(given or SOURCE / usual)
    if not os.access(path, os.X_OK):
        raise scenes.Failure(f"{path} is not there; build it (cmake --preset release && cmake --build --preset release) or name "
                             f"another with --{path.name}")
    return path.resolve()


def _setting(options, full, quick):
    """Of the options, where given; else of (width, height, samples)."""
    width, height, samples = quick if options.quick else full
    return Setting(options.width or width, options.height or height, options.samples or samples, options.bounces,
                   options.threads or os.cpu_count())


def _table(options):
    setting = _setting(options, full=(960, 540, 16), quick=(320, 180, 8))
    names = options.scenes or (list(scenes.STANDS_FOR) if options.quick else [*scenes.STANDS_FOR, "still-life", "room"])
    roundings = options.roundings or (["none", "analytic", "mesh:3", "bevel:4"] if options.quick else table.ROUNDINGS)
    table.run(Context(options, names), names, roundings, options.rounds or (2 if options.quick else 5), setting,
              deadline=120 if options.quick else None)


def _flight(options):
    setting = _setting(options, full=(960, 540, 16), quick=(320, 180, 8))
    flight.run(Context(options, [options.scene]), options.scene, options.roundings or ["analytic", "bevel:4"],
               options.steps or (5 if options.quick else 9), options.rounds or (1 if options.quick else 3), options.far,
               options.near, setting)


def _cycles(options):
    blender = cycles.find_blender(options.blender)
    if not blender:
        return
    setting = _setting(options, full=(960, 540, 16), quick=(320, 180, 16))
    names = options.scenes or (["gems", "still-life"] if options.quick else [*scenes.STANDS_FOR, "still-life", "room"])
    cycles.run(Context(options, names), blender, names, options.rounds or (1 if options.quick else 3), setting)


def _shared(parser):
    parser.add_argument("-o", "--output", default=str(SOURCE / "build/bench"),
                        help="folder of the results (default: %(default)s)")
    parser.add_argument("--quick", action="store_true",
                        help="small pictures, few samples and variants: ends within three minutes")
    parser.add_argument("--rounds", type=int, help="repetitions of everything; medians are taken over them")
    parser.add_argument("--width", type=int, help="pixels (default 960; quick 320)")
    parser.add_argument("--height", type=int, help="pixels (default 540; quick 180)")
    parser.add_argument("--samples", type=int, help="a pixel (default 16; quick 8, for cycles 16)")
    parser.add_argument("--bounces", type=int, default=8, help="longest path (default: %(default)s)")
    parser.add_argument("--threads", type=int, help="of every render (default: all cores)")
    parser.add_argument("--chamferd", help="program to measure (default: build/release/server/chamferd)")
    parser.add_argument("--chamferprep", help="program that rounds the scenes (default: build/release/preprocess/chamferprep)")
    parser.add_argument("--node", default="node", help="Node.js, which makes the scenes (default: %(default)s)")
    parser.add_argument("--fresh", action="store_true", help="forget earlier runs instead of going on with them")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    sub = commands.add_parser("table", help="every scene with every rounding (the paper's Table 1)",
                              description="Times every scene with every rounding, interleaved, and prints the paper's Table 1; "
                              "writes table.json and table.svg.")
    _shared(sub)
    sub.add_argument("--scenes", nargs="+", choices=scenes.ALL, metavar="SCENE", help="of " + ", ".join(scenes.ALL))
    sub.add_argument("--roundings", nargs="+", metavar="R",
                     help="of none, analytic, mesh:K, bevel:N (default: " + " ".join(table.ROUNDINGS) + ")")
    sub.set_defaults(command=_table)

    sub = commands.add_parser("flight", help="cost over the share of affected rays (the paper's Fig. 11)",
                              description="Moves the camera towards a scene's target and prints what each rounding costs over the "
                              "share of rays it affects; writes flight.json and flight.svg.")
    _shared(sub)
    sub.add_argument("--scene", default="gems", choices=scenes.ALL, metavar="SCENE", help="default: %(default)s")
    sub.add_argument("--roundings", nargs="+", metavar="R", help="beside none (default: analytic bevel:4)")
    sub.add_argument("--steps", type=int, help="cameras on the way (default 9; quick 5)")
    sub.add_argument("--far", type=float, default=6, help="first distance, of the scene's own camera (default: %(default)s)")
    sub.add_argument("--near", type=float, default=0.12, help="last distance (default: %(default)s)")
    sub.set_defaults(command=_flight)

    sub = commands.add_parser("cycles", help="the same scenes in Blender's Cycles",
                              description="Renders the scenes with chamferd and with Cycles (Blender 3.4, on the CPU): sharp, and "
                              "rounded by our method against Cycles' Bevel node (4 probes, the same radius) and the bevel "
                              "modifier. Writes cycles.json, SCENE-sharp.png and SCENE-rounded.png. Cycles' time is the "
                              "difference of a long and a short render on data that it keeps: no synchronisation, no hierarchy "
                              "building.")
    _shared(sub)
    sub.add_argument("--scenes", nargs="+", choices=[s for s in scenes.ALL if s != "wall"], metavar="SCENE",
                     help="of " + ", ".join(s for s in scenes.ALL if s != "wall"))
    sub.add_argument("--blender", default="blender", help="program (default: %(default)s)")
    sub.set_defaults(command=_cycles)

    options = parser.parse_args()
    try:
        options.command(options)
    except scenes.Failure as failure:
        print(f"bench.py: {failure}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("interrupted; the same command goes on from here", file=sys.stderr)
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
