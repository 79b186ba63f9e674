"""One measured process: its answer, its wall time and its own peak memory."""
import dataclasses
import os
import subprocess
import tempfile
import time


@dataclasses.dataclass
class Finished:
    status: int
    stdout: str
    stderr: str
    seconds: float  # wall, start to end
    peak_bytes: int  # largest resident set (ru_maxrss of this process alone)


def run(command, environment=None):
    """Runs to the end. Output goes to files: nothing has to be read while the process runs."""
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        begin = time.monotonic()
        process = subprocess.Popen([str(c) for c in command], stdin=subprocess.DEVNULL, stdout=out, stderr=err,
                                   env={**os.environ, **(environment or {})})
        try:
            _, wait_status, usage = os.wait4(process.pid, 0)
        except BaseException:
            process.kill()
            process.wait()
            raise
        seconds = time.monotonic() - begin
        process.returncode = os.waitstatus_to_exitcode(wait_status)  # Popen must not wait for it again
        out.seek(0)
        err.seek(0)
        return Finished(process.returncode, out.read().decode(errors="replace"), err.read().decode(errors="replace"),
                        seconds, usage.ru_maxrss * 1024)
