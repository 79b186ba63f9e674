"""One run of `chamferd render`, and the log that lets an interrupted benchmark go on."""
import dataclasses
import hashlib
import json
import os
import signal

from . import process
from .scenes import Failure, sharp_twin


@dataclasses.dataclass(frozen=True)
class Setting:
    """What every run of a benchmark has in common."""
    width: int
    height: int
    samples: int  # a pixel
    bounces: int
    threads: int


def arguments(program, scene, rounding, setting, output, camera=None):
    """The command line; `none` renders the scene's sharp twin. `camera`: {"eye", "target"}."""
    command = [program, "render", sharp_twin(scene) if rounding == "none" else scene, "-o", output, "--json",
               "--rounding", rounding, "--width", setting.width, "--height", setting.height, "--samples", setting.samples,
               "--bounces", setting.bounces, "--threads", setting.threads]
    for key, place in (camera or {}).items():
        command.append(f"--{key}=" + ",".join(f"{x:.9g}" for x in place))
    return [str(part) for part in command]


def measure(command):
    """Runs it; the report of chamferd with the process's own peak memory, or {"refused": message} when chamferd does not
    know or admit the rounding, or was killed for its memory."""
    done = process.run(command)
    if done.status == -signal.SIGKILL:
        return {"refused": f"killed at {done.peak_bytes / 2**30:.1f} GiB; the machine has too little memory"}
    if done.status in (2, 5):
        return {"refused": done.stderr.strip().removeprefix("chamferd: ")}
    if done.status != 0:
        raise Failure(f"chamferd ended with status {done.status}: {done.stderr.strip()}\n  {' '.join(command)}")
    report = json.loads(done.stdout)
    rays = report["rays"]
    traced = sum(rays[kind]["traced"] for kind in ("camera", "bounce"))
    rounded = sum(rays[kind]["rounded"] for kind in ("camera", "bounce"))
    return {
        "seconds": report["seconds"]["render"],
        "load_seconds": report["seconds"]["load"] + report["seconds"]["prepare"],
        "peak_bytes": done.peak_bytes,
        "triangles": report["triangles"],
        "samples": report["samples"],
        "rays": rays["all"]["traced"],
        "rounded_share": rounded / traced,  # of camera and bounce rays
        "load_average": os.getloadavg()[0],
    }


class RunLog:
    """Measured runs, one JSON object a line, each under a key that says what was run. A run that is there is not run
    again."""

    def __init__(self, path, program, fresh=False):
        self._path = path
        self._program = hashlib.sha256(open(program, "rb").read()).hexdigest()[:16]
        self._runs = {}
        if fresh:
            path.unlink(missing_ok=True)
        self._separator = ""
        if path.exists():
            text = path.read_text()
            self._separator = "\n" if text and not text.endswith("\n") else ""
            for line in text.splitlines():
                try:
                    entry = json.loads(line)
                except ValueError:
                    continue  # the line that an interruption cut off
                self._runs[entry["key"]] = entry["run"]

    def get(self, what, make):
        """The run called `what` of this program, made by `make()` unless it is known."""
        key = f"{self._program} {what}"
        if key not in self._runs:
            self._runs[key] = make()
            with open(self._path, "a", encoding="utf-8") as log:
                log.write(self._separator + json.dumps({"key": key, "run": self._runs[key]}) + "\n")
            self._separator = ""
        return self._runs[key]
