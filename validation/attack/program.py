"""Runs of the program with limits of time, memory and file size, and the files that they leave."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import tempfile
import threading
from dataclasses import dataclass, field
from pathlib import Path

# Codes of the table in the guide (docs/guide/src/start.md); 130 is an interruption before any result.
EXIT_CODES = {0, 1, 2, 3, 4, 130}
MAX_RESIDENT_MB = 1024
MAX_SECONDS = 120
MAX_LINE_LETTERS = 10_000
PARTS = (".part", ".tmp")


@dataclass
class Run:
    """How a run ended."""

    arguments: list[str]
    code: int
    resident_mb: float
    output: str
    errors: str
    # Unfinished files.
    left: list[str] = field(default_factory=list)

    def faults(self) -> list[str]:
        """Faults that no run may have, whatever its input."""
        found = []
        if self.code not in EXIT_CODES:
            found.append(f"ended with {self.code}")
        if "panicked" in self.errors or "RUST_BACKTRACE" in self.errors:
            found.append("panicked")
        if self.code not in (0, 130) and not (self.errors + self.output).strip():
            found.append(f"ended with {self.code} and without a message")
        # Output to `-` is for a program, with the content of the file.
        for_people = self.errors + ("" if "-" in self.arguments else self.output)
        steering = sorted({hex(ord(char)) for char in for_people if is_hidden(char)})
        if steering:
            found.append(f"sent {', '.join(steering)} to the terminal")
        if max(map(len, self.errors.split("\n"))) > MAX_LINE_LETTERS:
            found.append("wrote an endless line of errors")
        if self.left:
            found.append(f"left {', '.join(self.left)}")
        if self.resident_mb > MAX_RESIDENT_MB:
            found.append(f"took {self.resident_mb:.0f} MB")
        return [f"{' '.join(self.arguments)}: {fault}" for fault in found]


def is_hidden(char: str) -> bool:
    """Whether a character controls a terminal, ends a line invisibly, or reverses the writing direction."""
    code = ord(char)
    turns = code in (0x61C, 0x200E, 0x200F, 0xFEFF) or 0x2028 <= code <= 0x202E or 0x2060 <= code <= 0x206F
    return turns or (char != "\n" and (code < 32 or 127 <= code < 160))


def run(
    program: Path,
    arguments: list[str],
    folder: Path,
    *,
    largest_file: int | None = None,
    interrupt_after_s: float | None = None,
    environment: dict[str, str] | None = None,
) -> Run:
    """Runs the program in a folder; the file size can be limited, and Ctrl-C sent after a time."""

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        if largest_file is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (largest_file, largest_file))

    # Pipes have no file size limit, so outputs are not cut.
    with subprocess.Popen(
        [program, *arguments],
        cwd=folder,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        preexec_fn=limit,
        # Like Python, its child must ignore the signal of a too large file: it gets an error, as on a full disk.
        restore_signals=False,
        env=os.environ | {"NO_COLOR": "1", "HOME": str(folder)} | (environment or {}),
    ) as child:
        texts: dict[str, bytes] = {}
        readers = [
            threading.Thread(target=lambda name, pipe: texts.__setitem__(name, pipe.read()), args=(name, pipe))
            for name, pipe in (("output", child.stdout), ("errors", child.stderr))
        ]
        for reader in readers:
            reader.start()
        timers = [threading.Timer(MAX_SECONDS, child.kill)]
        if interrupt_after_s is not None:
            timers.append(threading.Timer(interrupt_after_s, lambda: send_interrupt(child)))
        for timer in timers:
            timer.start()
        _, status, usage = os.wait4(child.pid, 0)
        # As in a shell: 130 if Ctrl-C came before the program listened for it.
        code = os.waitstatus_to_exitcode(status)
        child.returncode = code if code >= 0 else 128 - code
        for timer in timers:
            timer.cancel()
        for reader in readers:
            reader.join()
    return Run(
        arguments,
        child.returncode,
        usage.ru_maxrss / 1024,
        texts["output"].decode(errors="replace"),
        texts["errors"].decode(errors="replace"),
    )


def send_interrupt(child: subprocess.Popen[bytes]) -> None:
    """Ctrl-C, if the program still runs."""
    try:
        os.kill(child.pid, signal.SIGINT)
    except ProcessLookupError:
        pass


def parts(folder: Path) -> list[str]:
    """Unfinished files of a run."""
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.name.endswith(PARTS))


def temporary() -> tempfile.TemporaryDirectory[str]:
    """A folder that is removed at the end."""
    return tempfile.TemporaryDirectory(prefix="spineline-attack-")
