"""The command line: parse, call one use case, write its results."""

import argparse
import json
import os
import sys
import traceback
import warnings
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import fields
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, NoReturn

from treestroke import __version__
from treestroke.cli_backup import add_backup_flags, add_restore_flags, backup, restore
from treestroke.cli_inputs import UsageError, chosen_settings, inputs_of, project_stem, whole
from treestroke.cli_keys import add_key_flags, keys, migrate
from treestroke.cli_outputs import ProgressLine, check_further, outputs_of, stem
from treestroke.codec.inputs import BESIDE, PARTS, SOURCES, Source
from treestroke.codec.photo_kinds import ACCEPTED_FORMATS
from treestroke.core.errors import TreestrokeError
from treestroke.core.pipeline.settings import ModelSettings, Several, Toggle
from treestroke.core.progress import silent
from treestroke.memory import search_for_garbage_often
from treestroke.store.data_folder import DataFolderError

if TYPE_CHECKING:
    Commands = argparse._SubParsersAction["Parser"]

BAD_INPUT, OUR_FAULT, INTERRUPTED = 2, 1, 130
_PART_WIDTH = 13
_PRINTED = ("side_assumed", "photo_cut_short", "outside_photo", "crown_unclear", "trunk_unclear")
"""Codes of the warnings that are printed: something was assumed, or what was drawn may not be a tree."""


class MachineFault(Exception):
    """The machine's fault; its message is one line for the person."""


class Parser(argparse.ArgumentParser):
    """An argument parser that raises its message instead of printing the usage."""

    def error(self, message: str) -> NoReturn:
        """Raise the message as a `UsageError`."""
        raise UsageError(f"{message}; see {self.prog} --help")


def run() -> NoReturn:
    """Run the command line and exit with its code; a programming error is printed as one line, too."""
    if "--debug" not in sys.argv:
        sys.excepthook = _one_line
    # treestroke has no pydantic plugins; to look for some takes longer than to check strokes.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    sys.exit(main())


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; return its exit code: 0, 2 bad input, 1 the machine's fault, 130 interrupted."""
    arguments = list(sys.argv[1:] if argv is None else argv)
    try:
        options = _parser().parse_args(arguments)
        with warnings.catch_warnings():
            if not options.debug:
                warnings.simplefilter("ignore")
            with _library_output_hidden() if options.reads and not options.debug else nullcontext():
                options.command(options)
    except TreestrokeError as error:
        return _fail(BAD_INPUT, str(error), "--debug" in arguments)
    except (MachineFault, DataFolderError) as error:
        return _fail(OUR_FAULT, str(error), "--debug" in arguments)
    except (OSError, MemoryError) as error:
        return _fail(OUR_FAULT, f"{_fault(error)}; nothing was written", "--debug" in arguments)
    except KeyboardInterrupt as error:
        return _fail(INTERRUPTED, str(error) or "interrupted; nothing was written", debug=False)
    return 0


def _parser() -> Parser:
    parser = Parser(
        prog="treestroke",
        description="Photos or a video of a tree and a few strokes, or two sketches of it, become a 3D tree.",
    )
    parser.add_argument("--version", action="version", version=f"treestroke {__version__}")
    commands = parser.add_subparsers(title="commands", required=True, metavar="COMMAND")
    for add in (_add_model, _add_views, _add_video, _add_sketch, _add_siblings, _add_trace, _add_service):
        add(commands)
    return parser


def _add_model(commands: "Commands") -> None:
    command = _add_command(commands, "model", _make, "make a GLB of a photo")
    _add_inputs(command, SOURCES["photo"], ("photo",))
    _add_outputs(command)
    _add_settings(command)


def _add_views(commands: "Commands") -> None:
    command = _add_command(commands, "views", _make, "make a GLB of many photos of one tree")
    command.set_defaults(first="photos")
    about = f"photos of the tree from all sides, {ACCEPTED_FORMATS}, or their folder; or a NAME.treestroke project"
    command.add_argument("photos", metavar="PHOTO", nargs="+", help=about)
    command.add_argument("--strokes", metavar="VIEWS.json", dest="views", help=PARTS["views"].help)
    for name in BESIDE:
        _add_part(command, name)
    _add_outputs(command)
    _add_settings(command)


def _add_video(commands: "Commands") -> None:
    command = _add_command(commands, "video", _make, "make a GLB of a video: a tree that moves")
    command.set_defaults(first="clip")
    command.add_argument("clip", metavar="CLIP", help=f"{PARTS['clip'].help}; or a NAME.treestroke project")
    command.add_argument("--strokes", metavar="STROKES.json", dest="frame_strokes", help=PARTS["frame_strokes"].help)
    for name in BESIDE:
        _add_part(command, name)
    _add_outputs(command)
    _add_settings(command)


def _add_sketch(commands: "Commands") -> None:
    command = _add_command(commands, "sketch", _make, "make a GLB of sketches")
    _add_inputs(command, SOURCES["sketches"], ("front", "side"))
    _add_outputs(command)
    _add_settings(command)


def _add_siblings(commands: "Commands") -> None:
    command = _add_command(commands, "siblings", _siblings, "make other trees of the same kind")
    command.set_defaults(first="project")
    command.add_argument("project", metavar="TREE.treestroke", help="project of the tree")
    command.add_argument("--count", metavar="N", default="1", help="how many (default 1)")
    command.add_argument("--out", metavar="DIR", type=Path, required=True, help="folder for TREE.s1.glb and so on")
    command.add_argument("--outline", metavar="OUTLINE", dest="envelope", help=PARTS["envelope"].help)
    command.add_argument("--scene", metavar="SCENE.glb", type=Path, help="all of them beside each other")
    command.add_argument("--report", metavar="REPORT.json", type=Path, help="seconds, counts and score of each")
    command.add_argument("--preview", metavar="PICTURE.png", type=Path, help="the first one: front view and 3/4 view")
    _add_settings(command, ("variants", "siblings", "grove"))


def _add_trace(commands: "Commands") -> None:
    command = _add_command(commands, "trace", _trace, "find foliage and branches")
    command.set_defaults(first="photo")
    command.add_argument("photo", metavar="PHOTO", help=ACCEPTED_FORMATS)
    command.add_argument("--strokes", metavar="STROKES.json", required=True, help="the strokes drawn over it")
    command.add_argument("--out", metavar="TRACE.json", type=Path, help="standard output where absent")
    command.add_argument(
        "--overlay", metavar="OVERLAY.png", type=Path, help="the photo with what was found drawn over it"
    )


def _add_service(commands: "Commands") -> None:
    serve = _add_command(commands, "serve", _serve, "answer over HTTP, with a page")
    serve.add_argument("--host", help="this machine's own address to listen on (default 127.0.0.1)")
    serve.add_argument("--port", help="port to listen on (default 8000; 0 takes a free one)")
    worker = _add_command(commands, "worker", _worker, "grow models for a service elsewhere")
    doctor = _add_command(commands, "doctor", _doctor, "say what is missing or broken")
    keys = _add_command(commands, "keys", _keys, "make, list and revoke the keys of a team")
    add_key_flags(keys)
    backup = _add_command(commands, "backup", _backup, "write a service's rows and files into a folder")
    add_backup_flags(backup)
    restore = _add_command(commands, "restore", _restore, "write a backup into an empty service")
    add_restore_flags(restore)
    migrate = _add_command(commands, "migrate", _migrate, "bring the tables of a service up to date")
    for command in (serve, worker, doctor, keys, backup, restore, migrate):
        command.add_argument("--data", metavar="DIR", help="folder of the service's data (default ~/.treestroke)")


def _add_command(
    commands: "Commands", name: str, action: Callable[[argparse.Namespace], None], about: str
) -> argparse.ArgumentParser:
    command = commands.add_parser(name, help=about, allow_abbrev=False)
    command.add_argument("--debug", action="store_true", help="show the trace of an error")
    command.set_defaults(command=action, reads=action in (_make, _siblings, _trace))
    return command


def _add_inputs(command: argparse.ArgumentParser, source: Source, by_position: Sequence[str]) -> None:
    """Add the parts of a source as flags, some ``by_position``; a project may take the place of the first."""
    command.set_defaults(first=by_position[0])
    for name in (*source.needs, *source.options):
        if name == by_position[0]:
            about = f"{PARTS[name].help}; or a NAME.treestroke project"
            command.add_argument(name, metavar=_metavar(name), help=about)
        elif name in by_position:
            command.add_argument(name, metavar=_metavar(name), help=PARTS[name].help, nargs="?")
        else:
            _add_part(command, name)


def _add_part(command: argparse.ArgumentParser, name: str) -> None:
    command.add_argument(f"--{name}", metavar=_metavar(name), help=PARTS[name].help)


def _metavar(name: str) -> str:
    formats = PARTS[name].formats
    return f"{name.upper()}.{formats[0].ending}" if len(formats) == 1 else name.upper()


def _add_outputs(command: argparse.ArgumentParser) -> None:
    command.add_argument("--out", metavar="TREE.glb", type=Path, required=True, help="the tree")
    command.add_argument("--report", metavar="REPORT.json", type=Path, help="seconds, counts, score and warnings")
    command.add_argument("--preview", metavar="PICTURE.png", type=Path, help="front view and 3/4 view")


def _add_settings(command: argparse.ArgumentParser, without: Collection[str] = ()) -> None:
    command.add_argument("--seed", metavar="N", help="a whole number from 0 (default 0)")
    for entry in (entry for entry in fields(ModelSettings) if entry.name not in without):
        names = dict.fromkeys(f"--{entry.name.replace('_', mark)}" for mark in "-_")
        allowed, meaning = entry.metadata["allowed"], entry.metadata["meaning"]
        if isinstance(allowed, Toggle):
            command.add_argument(*names, dest=entry.name, action=argparse.BooleanOptionalAction, help=meaning)
            continue
        several = isinstance(allowed, Several)
        about = f"{meaning}: {allowed} (default {'none' if several else entry.default})"
        command.add_argument(*names, dest=entry.name, metavar="A,B" if several else "VALUE", help=about)


def _make(options: argparse.Namespace) -> None:
    outputs = outputs_of(options, ("out", "report", "preview"))
    inputs, settings = inputs_of(options)
    settings |= chosen_settings(options)
    from treestroke.codec.image import encode_png
    from treestroke.engines.solving import SolveEnded
    from treestroke.service.model import Options, make_tree
    from treestroke.store.atomic_write import write_atomically

    seed = settings.pop("seed", 0)
    wanted = Options.of(settings, seed, stem(options.out))
    line = ProgressLine(sys.stderr, wanted.settings.iterations) if sys.stderr.isatty() else None
    try:
        result = make_tree(inputs, wanted, line or silent)
    except SolveEnded as ended:
        raise MachineFault(f"{ended}; nothing was written") from ended
    finally:
        if line:
            line.clear()
    makers: dict[str, Callable[[], bytes]] = {
        "out": lambda: result.glb,
        "report": lambda: json.dumps(result.report, indent=2).encode() + b"\n",
        "preview": lambda: encode_png(result.preview()),
    }
    further = {options.out.with_name(name): content for name, content in list(result.files.items())[1:]}
    check_further(options, further)
    write_atomically({path: makers[name]() for name, path in outputs.items()} | further)
    _print_warnings(result.report["warnings"])


def _siblings(options: argparse.Namespace) -> None:
    outputs = outputs_of(options, ("scene", "report", "preview"))
    if options.out.exists() and not options.out.is_dir():
        raise UsageError(f"--out {options.out}: it is a file; name a folder")
    settings = chosen_settings(options)
    from treestroke.codec.image import encode_png
    from treestroke.service.sibling_models import siblings
    from treestroke.store.atomic_write import write_atomically

    name, seed = project_stem(options.project), settings.pop("seed", None)
    line = ProgressLine(sys.stderr, ModelSettings().iterations) if sys.stderr.isatty() else None
    try:
        made = siblings(
            options.project,
            whole(options.count),
            settings,
            seed,
            outline=options.envelope,
            scene=options.scene is not None,
            report=line or silent,
            name=name,
        )
    finally:
        if line:
            line.clear()
    files = dict(made.files)
    makers: dict[str, Callable[[], bytes]] = {
        "scene": lambda: files.pop(f"{name}.grove.glb"),
        "report": lambda: json.dumps(made.report, indent=2).encode() + b"\n",
        "preview": lambda: encode_png(made.preview()),
    }
    written = {path: makers[name]() for name, path in outputs.items()}
    further = {options.out / name: content for name, content in files.items()}
    check_further(options, further)
    options.out.mkdir(parents=True, exist_ok=True)
    write_atomically(written | further)
    _print_warnings(made.report["warnings"])


def _print_warnings(warnings: Sequence[Mapping[str, str]]) -> None:
    for warning in warnings:
        if warning["code"] in _PRINTED or warning["stroke"].startswith(("photos/", "clip")):
            print(f"treestroke: {warning['stroke']}: {warning['detail']}", file=sys.stderr)


def _trace(options: argparse.Namespace) -> None:
    outputs = outputs_of(options, ("out", "overlay"))
    from treestroke.codec.image import encode_png
    from treestroke.service.trace import trace
    from treestroke.store.atomic_write import write_atomically

    result = trace(options.photo, options.strokes)
    found = result.as_dict()
    answer = json.dumps(found)
    makers: dict[str, Callable[[], bytes]] = {
        "out": lambda: answer.encode() + b"\n",
        "overlay": lambda: encode_png(result.overlay()),
    }
    write_atomically({path: makers[name]() for name, path in outputs.items()})
    if options.out is None:
        print(answer)
    _print_warnings(found["warnings"])


def _serve(options: argparse.Namespace) -> None:
    from treestroke.serve import serve

    serve(_service_settings(options))


def _worker(options: argparse.Namespace) -> None:
    from treestroke.worker import main as work

    search_for_garbage_often()
    os.environ.update(_service_settings(options).environment())
    if work():
        raise MachineFault("the worker did not start; its log says why")


def _doctor(options: argparse.Namespace) -> None:
    settings = _service_settings(options)
    from treestroke.service.doctor import examine

    examined = ill = 0
    for finding in examine(settings):
        examined, ill = examined + 1, ill + (not finding.ok)
        print(f"{'ok ' if finding.ok else 'ILL'}  {finding.part:<{_PART_WIDTH}}  {finding.found}", flush=True)
        if finding.mend:
            print(f"     {'':<{_PART_WIDTH}}  mend: {finding.mend}", flush=True)
    if ill:
        raise MachineFault(f"{ill} of {examined} parts are ill")


def _keys(options: argparse.Namespace) -> None:
    keys(_service_settings(options), options)


def _backup(options: argparse.Namespace) -> None:
    backup(_service_settings(options), options)


def _restore(options: argparse.Namespace) -> None:
    restore(_service_settings(options), options)


def _migrate(options: argparse.Namespace) -> None:
    migrate(_service_settings(options))


def _service_settings(options: argparse.Namespace) -> Any:
    from treestroke.settings import read_settings

    flags = {name: getattr(options, name, None) for name in ("host", "port", "data")}
    return read_settings(**{name: value for name, value in flags.items() if value is not None})


@contextmanager
def _library_output_hidden() -> Iterator[None]:
    """Hide what libraries in C print about a damaged picture; the error's one line says it."""
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
