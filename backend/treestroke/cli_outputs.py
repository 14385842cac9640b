"""What a command writes: the paths that its arguments name, and the line that shows how far it is."""

import argparse
import os
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import TextIO

from treestroke.cli_inputs import UsageError, read_by


class ProgressLine:
    """One line on a terminal that is rewritten as the work goes on."""

    def __init__(self, stream: TextIO, iterations: int) -> None:
        self._stream = stream
        self._iterations = iterations

    def __call__(self, stage: str, fraction: float) -> None:
        """Show the stage, its per cent and, in growth, its iterations."""
        rounds = f" ({round(fraction * self._iterations)} of {self._iterations} iterations)" if stage == "grow" else ""
        self._stream.write(f"\r\x1b[K{stage} {fraction:.0%}{rounds}")
        self._stream.flush()

    def clear(self) -> None:
        """Clear the line."""
        self._stream.write("\r\x1b[K")
        self._stream.flush()


def stem(out: Path) -> str:
    """Return what the names of all files beside OUT begin with."""
    return out.stem if out.suffix.lower() == ".glb" else out.name


def outputs_of(options: argparse.Namespace, names: Sequence[str]) -> dict[str, Path]:
    """Return the paths to write, by flag; refuse, before any work, those that cannot be written."""
    outputs = {name: path for name in names if (path := getattr(options, name)) is not None}
    taken = read_by(options)
    for name, path in outputs.items():
        if path.is_dir() or not path.parent.is_dir():
            problem = "it is a folder" if path.is_dir() else f"there is no folder {path.parent}"
            raise UsageError(f"--{name} {path}: {problem}; name a file in a folder that exists")
        place = os.path.realpath(path)
        if place in taken and path.is_file():
            raise UsageError(f"--{name} {path}: another file of this command has this name; choose one of its own")
        taken.add(place)
    return outputs


def check_further(options: argparse.Namespace, further: Collection[Path]) -> None:
    """Refuse to write over a file that the command reads."""
    read = read_by(options)
    for path in further:
        if os.path.realpath(path) in read or path.is_dir():
            problem = "the command reads it" if path.is_file() else "it is a folder"
            raise UsageError(f"{path}: a file of this name is to be written, but {problem}; choose another --out")
