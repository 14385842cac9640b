"""The command line: parse, call one use case, answer."""

import argparse
import json
import os
import sys
import traceback
import warnings
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import fields, replace
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, NoReturn, TextIO

from treestroke import __version__
from treestroke.core.errors import TreestrokeError
from treestroke.core.pipeline.settings import ModelSettings, Several, Span, Toggle
from treestroke.core.progress import silent
from treestroke.store.data_folder import DataFolderError

if TYPE_CHECKING:
    from treestroke.service.evidence import Evidence

BAD_INPUT, OUR_FAULT, INTERRUPTED = 2, 1, 130
_PART_WIDTH = 13
_ALOUD = ("side_assumed", "photo_cut_short", "trunk_level", "outside_photo", "crown_unclear")
"""Codes of the warnings that are said aloud: nobody drew what they speak of, or it may be no tree."""


class UsageError(TreestrokeError):
    """The command itself is wrong."""


class MachineFault(Exception):
    """The machine's fault, in a line that says all there is to say."""


class Parser(argparse.ArgumentParser):
    """An argument parser whose complaint is one line."""

    def error(self, message: str) -> NoReturn:
        """Raise instead of printing the usage."""
        raise UsageError(f"{message}; see {self.prog} --help")


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
        """Leave an empty line."""
        self._stream.write("\r\x1b[K")
        self._stream.flush()


def run() -> NoReturn:
    """Run the command line and leave with its exit code; our own mistakes become one line too."""
    if "--debug" not in sys.argv:
        sys.excepthook = _one_line
    sys.exit(main())


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; give its exit code: 0, 2 bad input, 1 the machine's fault, 130 interrupted."""
    given = list(sys.argv[1:] if argv is None else argv)
    try:
        options = _parser().parse_args(given)
        with warnings.catch_warnings():
            if not options.debug:
                warnings.simplefilter("ignore")
            with _own_words() if options.reads and not options.debug else nullcontext():
                options.command(options)
    except TreestrokeError as error:
        return _fail(BAD_INPUT, str(error), "--debug" in given)
    except (MachineFault, DataFolderError) as error:
        return _fail(OUR_FAULT, str(error), "--debug" in given)
    except (OSError, MemoryError) as error:
        return _fail(OUR_FAULT, f"{_fault(error)}; nothing was written", "--debug" in given)
    except KeyboardInterrupt:
        return _fail(INTERRUPTED, "interrupted; nothing was written", debug=False)
    return 0


def _parser() -> Parser:
    parser = Parser(
        prog="treestroke", description="One photo of a tree and a few strokes, or two sketches of it, become a 3D tree."
    )
    parser.add_argument("--version", action="version", version=f"treestroke {__version__}")
    commands = parser.add_subparsers(title="commands", required=True, metavar="COMMAND")
    model = commands.add_parser("model", help="make a GLB of a photo", allow_abbrev=False)
    model.add_argument(
        "photo", metavar="PHOTO", help="JPEG, PNG, WebP, HEIC, AVIF or TIFF; or a NAME.treestroke project"
    )
    model.add_argument("--strokes", metavar="STROKES.json", help="needed with a photo")
    model.add_argument("--side", metavar="SIDE", help="sketch of the tree's left side: stroke JSON or PNG")
    sketch = commands.add_parser("sketch", help="make a GLB of sketches", allow_abbrev=False)
    sketch.add_argument("front", metavar="FRONT", help="stroke JSON or PNG; or a NAME.treestroke project")
    sketch.add_argument("side", metavar="SIDE", nargs="?", help="the same tree from its left")
    sketch.add_argument("--photo", metavar="PHOTO", help="what FRONT was drawn over; it lends its colours")
    for maker, first in ((model, "photo"), (sketch, "front")):
        maker.set_defaults(first=first)
        _add_making(maker)
    trace = commands.add_parser("trace", help="find foliage and branches", allow_abbrev=False)
    trace.add_argument("photo", metavar="PHOTO", help="JPEG, PNG, WebP, HEIC, AVIF or TIFF")
    trace.add_argument("--strokes", metavar="STROKES.json", required=True)
    trace.add_argument("--out", metavar="TRACE.json", type=Path, help="standard output where absent")
    trace.add_argument(
        "--overlay", metavar="OVERLAY.png", type=Path, help="the photo with what was found drawn over it"
    )
    serve = commands.add_parser("serve", help="answer over HTTP, with a page", allow_abbrev=False)
    serve.add_argument("--host", help="this machine's own address to listen on (default 127.0.0.1)")
    serve.add_argument("--port", help="port to listen on (default 8000; 0 takes a free one)")
    worker = commands.add_parser("worker", help="grow models for a service elsewhere", allow_abbrev=False)
    doctor = commands.add_parser("doctor", help="say what is missing or broken", allow_abbrev=False)
    for command in (serve, worker, doctor):
        command.add_argument("--data", metavar="DIR", help="folder of the service's data (default ~/.treestroke)")
    for command, action in (
        (model, _make),
        (sketch, _make),
        (trace, _trace),
        (serve, _serve),
        (worker, _worker),
        (doctor, _doctor),
    ):
        command.add_argument("--debug", action="store_true", help="show the trace of an error")
        command.set_defaults(command=action, reads=action in (_make, _trace))
    return parser


def _add_making(maker: argparse.ArgumentParser) -> None:
    """Add what is common to all commands that make a tree."""
    maker.add_argument("--out", metavar="TREE.glb", type=Path, required=True)
    maker.add_argument("--report", metavar="REPORT.json", type=Path, help="seconds, counts, score and warnings")
    maker.add_argument("--preview", metavar="PICTURE.png", type=Path, help="front view and 3/4 view")
    maker.add_argument("--seed", metavar="N", help="a whole number from 0 (default 0)")
    maker.add_argument("--leaf", metavar="LEAF.png", help="a leaf cut out, stalk down, that the tree is to bear")
    maker.add_argument("--fruit", metavar="FRUIT.png", help="a fruit cut out, stalk up, that the tree is to bear")
    for entry in fields(ModelSettings):
        names = dict.fromkeys(f"--{entry.name.replace('_', mark)}" for mark in "-_")
        allowed, meaning = entry.metadata["allowed"], entry.metadata["meaning"]
        if isinstance(allowed, Toggle):
            maker.add_argument(*names, dest=entry.name, action=argparse.BooleanOptionalAction, help=meaning)
            continue
        several = isinstance(allowed, Several)
        about = f"{meaning}: {allowed} (default {'none' if several else entry.default})"
        maker.add_argument(*names, dest=entry.name, metavar="A,B" if several else "VALUE", help=about)


def _make(options: argparse.Namespace) -> None:
    outputs = _outputs(options, ("out", "report", "preview"))
    given, settings = _evidence(options)
    settings |= _chosen(options)
    from treestroke.codec.image import encode_png
    from treestroke.service.evidence import make_of
    from treestroke.service.inputs import load_settings
    from treestroke.store.atomic_write import write_atomically

    seed, chosen = settings.pop("seed", 0), load_settings(settings)
    line = ProgressLine(sys.stderr, chosen.iterations) if sys.stderr.isatty() else None
    try:
        result = make_of(given, chosen, seed, line or silent, name=_stem(options.out))
    finally:
        if line:
            line.clear()
    makers: dict[str, Callable[[], bytes]] = {
        "out": lambda: result.glb,
        "report": lambda: json.dumps(result.report, indent=2).encode() + b"\n",
        "preview": lambda: encode_png(result.preview()),
    }
    further = {options.out.with_name(name): content for name, content in list(result.files.items())[1:]}
    _check_further(options, further)
    write_atomically({path: makers[name]() for name, path in outputs.items()} | further)
    _say_aloud(result.report["warnings"])


def _say_aloud(warnings: Sequence[Mapping[str, str]]) -> None:
    for warning in warnings:
        if warning["code"] in _ALOUD:
            print(f"treestroke: {warning['stroke']}: {warning['detail']}", file=sys.stderr)


def _stem(out: Path) -> str:
    """Give the name that all files beside OUT begin with."""
    return out.stem if out.suffix.lower() == ".glb" else out.name


def _check_further(options: argparse.Namespace, further: Collection[Path]) -> None:
    """Refuse to write over what was read."""
    read = _read(options)
    for path in further:
        if os.path.realpath(path) in read or path.is_dir():
            problem = "the command reads it" if path.is_file() else "it is a folder"
            raise UsageError(f"{path}: a file of this name is to be written, but {problem}; choose another --out")


def _trace(options: argparse.Namespace) -> None:
    outputs = _outputs(options, ("out", "overlay"))
    from treestroke.codec.image import encode_png
    from treestroke.service.trace import trace
    from treestroke.store.atomic_write import write_atomically

    result = trace(options.photo, options.strokes)
    found = result.answer()
    answer = json.dumps(found)
    makers: dict[str, Callable[[], bytes]] = {
        "out": lambda: answer.encode() + b"\n",
        "overlay": lambda: encode_png(result.overlay()),
    }
    write_atomically({path: makers[name]() for name, path in outputs.items()})
    if options.out is None:
        print(answer)
    _say_aloud(found["warnings"])


def _serve(options: argparse.Namespace) -> None:
    from treestroke.serve import serve

    serve(_service_settings(options))


def _worker(options: argparse.Namespace) -> None:
    from treestroke.worker import main as work

    os.environ.update(_service_settings(options).environment())
    if work():
        raise MachineFault("the worker did not start; its log says why")


def _doctor(options: argparse.Namespace) -> None:
    settings = _service_settings(options)
    from treestroke.service.doctor import examine

    looked = ill = 0
    for finding in examine(settings):
        looked, ill = looked + 1, ill + (not finding.ok)
        print(f"{'ok ' if finding.ok else 'ILL'}  {finding.part:<{_PART_WIDTH}}  {finding.found}", flush=True)
        if finding.mend:
            print(f"     {'':<{_PART_WIDTH}}  mend: {finding.mend}", flush=True)
    if ill:
        raise MachineFault(f"{ill} of {looked} parts are ill")


def _service_settings(options: argparse.Namespace) -> Any:
    from treestroke.settings import read_settings

    given = {name: getattr(options, name, None) for name in ("host", "port", "data")}
    return read_settings(**{name: value for name, value in given.items() if value is not None})


def _evidence(options: argparse.Namespace) -> tuple["Evidence", dict[str, Any]]:
    """Collect what the tree is made of, and a project's settings, the seed among them."""
    from treestroke.service.evidence import Evidence
    from treestroke.service.inputs import load_project

    parts = _parts(options)
    if not parts[options.first].endswith(".treestroke"):
        if options.first == "photo" and "strokes" not in parts:
            raise UsageError("--strokes is missing; name the strokes' JSON file")
        return Evidence(**parts), {}
    pictures = {part: parts.pop(part) for part in ("leaf", "fruit") if part in parts}
    path = parts.pop(options.first)
    for part in parts:
        raise UsageError(f"--{part}: a project has its own {part}; leave the flag out")
    project = load_project(path)
    return replace(Evidence.of(project), **pictures), project.settings


def _parts(options: argparse.Namespace) -> dict[str, str]:
    """Give the files that the tree is made of, by part."""
    parts = {part: getattr(options, part, None) for part in ("photo", "strokes", "front", "side", "leaf", "fruit")}
    return {part: path for part, path in parts.items() if path is not None}


def _read(options: argparse.Namespace) -> set[str]:
    """Give the places of all files that the command reads."""
    return {os.path.realpath(path) for path in _parts(options).values()}


def _chosen(options: argparse.Namespace) -> dict[str, Any]:
    """Collect the settings that flags name, and the seed."""
    flags = {entry.name: getattr(options, entry.name) for entry in fields(ModelSettings)}
    settings: dict[str, Any] = {name: _value(name, text) for name, text in flags.items() if text is not None}
    return settings if options.seed is None else {**settings, "seed": _whole(options.seed)}


def _value(name: str, text: str | bool) -> object:
    """Read a flag's value as the setting's kind; what does not fit stays text, which the settings refuse by name."""
    allowed = {entry.name: entry.metadata["allowed"] for entry in fields(ModelSettings)}[name]
    if isinstance(text, bool):
        return text
    if isinstance(allowed, Several):
        return [one.strip() for one in text.split(",") if one.strip()]
    if not isinstance(allowed, Span):
        return text
    try:
        return int(text) if allowed.whole else float(text)
    except ValueError:
        return text


def _whole(text: str) -> object:
    try:
        return int(text)
    except ValueError:
        return text


def _outputs(options: argparse.Namespace, names: Sequence[str]) -> dict[str, Path]:
    """Collect the files to write; refuse, before any work, places that no file can have."""
    outputs = {name: path for name in names if (path := getattr(options, name)) is not None}
    taken = _read(options)
    for name, path in outputs.items():
        if path.is_dir() or not path.parent.is_dir():
            problem = "it is a folder" if path.is_dir() else f"there is no folder {path.parent}"
            raise UsageError(f"--{name} {path}: {problem}; name a file in a folder that exists")
        place = os.path.realpath(path)
        if place in taken and path.is_file():
            raise UsageError(f"--{name} {path}: another file of this command has this name; choose one of its own")
        taken.add(place)
    return outputs


@contextmanager
def _own_words() -> Iterator[None]:
    """Keep what libraries in C print of a damaged picture from standard error: one line of ours says it."""
    shown, kept = sys.stderr, os.dup(2)
    try:
        with open(os.devnull, "wb") as nowhere, os.fdopen(os.dup(kept), "w", 1, errors="backslashreplace") as ours:
            if shown is sys.__stderr__:
                sys.stderr = ours
            os.dup2(nowhere.fileno(), 2)
            yield
    finally:
        sys.stderr = shown
        os.dup2(kept, 2)
        os.close(kept)


def _fault(error: OSError | MemoryError) -> str:
    if isinstance(error, MemoryError):
        return "there is not enough memory; close other programs or take a smaller photo"
    where = f"{error.filename}: " if error.filename else ""
    return f"{where}{error.strerror or error}; free space or choose another place"


def _fail(code: int, message: str, debug: bool) -> int:
    if debug:
        traceback.print_exc()
    print(f"treestroke: {' '.join(message.split())}", file=sys.stderr)
    return code


def _one_line(kind: type[BaseException], error: BaseException, _: TracebackType | None) -> None:
    print(
        f"treestroke: our mistake, {kind.__name__}: {' '.join(str(error).split())}; --debug shows more", file=sys.stderr
    )
