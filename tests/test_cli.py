"""The command line, in process: exit codes, single lines, and files whole or not at all."""

import io
import json
import os
import resource
import signal
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import Any, NoReturn

import pytest
from PIL import Image
from tests import walked_capture
from tests.api import drawn, sketched
from tests.api.corpora import saved
from tests.core.pipeline.walked_capture import structure_of
from tests.core.segment.walked_tree import strokes_on, walk

import treestroke
from treestroke.cli import main
from treestroke.codec.image import decode_photo, encode_png
from treestroke.codec.project import write_project
from treestroke.codec.structure import encode_structure
from treestroke.codec.usd import has_usd
from treestroke.engines.solving import SolveEnded

QUICK = ["--iterations", "5"]


@pytest.fixture
def run(tmp_path: Path, maple_photo: Path, maple_strokes: Path, capsys: pytest.CaptureFixture[str]):
    """Run ``model`` on the maple with changes; give the exit code, the lines on stderr and the files left behind."""

    def run(*more: str, photo: object = maple_photo, strokes: object = maple_strokes, out: str = "tree.glb"):
        code = main(["model", str(photo), "--strokes", str(strokes), "--out", str(tmp_path / out), *QUICK, *more])
        return code, capsys.readouterr().err.splitlines(), sorted(p.name for p in tmp_path.iterdir())

    return run


@pytest.fixture
def draw(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Run ``sketch`` on drawn sides of a small tree; give the exit code, the lines on stderr and the files left."""
    places = {}
    for view, given in (("front", sketched.FRONT), ("side", sketched.SIDE)):
        places[view] = tmp_path.parent / f"{tmp_path.name}.{view}.json"
        places[view].write_text(json.dumps(given))

    def draw(*more: str, views: tuple[str, ...] = ("front", "side")):
        given = [str(places.get(view, view)) for view in views]
        code = main(["sketch", *given, "--out", str(tmp_path / "tree.glb"), "--leaf-density", "0.2", *QUICK, *more])
        return code, capsys.readouterr().err.splitlines(), sorted(p.name for p in tmp_path.iterdir())

    return draw


def strokes_file(tmp_path: Path, maple_strokes: Path, **changes: object) -> Path:
    path = tmp_path.parent / f"{tmp_path.name}.strokes.json"
    path.write_text(json.dumps({**json.loads(maple_strokes.read_text()), **changes}))
    return path


def picture_file(tmp_path: Path, image: Image.Image, ending: str = "png") -> Path:
    path = tmp_path.parent / f"{tmp_path.name}.{ending}"
    image.save(path)
    return path


def test_version_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as left:
        main(["--version"])
    assert left.value.code == 0
    assert capsys.readouterr().out == f"treestroke {treestroke.__version__}\n"


@pytest.mark.parametrize(
    "argv",
    [
        [],
        ["grow"],
        ["model"],
        ["model", "photo.jpg"],
        ["model", "photo.jpg", "--out", "x.glb"],
        ["model", "photo.jpg", "--strokes", "s.json", "--out", "x.glb", "--wind", "3"],
        ["model", "photo.jpg", "--strokes", "s.json", "--out", "x.glb", "--heigh", "3"],
        ["model", "photo.jpg", "other.jpg", "--strokes", "s.json", "--out", "x.glb"],
        ["model", "photo.jpg", "--strokes", "s.json", "--out"],
        ["model", "a.treestroke", "--strokes", "s.json", "--out", "x.glb"],
        ["model", "a.treestroke", "--side", "side.json", "--out", "x.glb"],
        ["model", "photo.jpg", "--strokes", "s.json", "--photo", "b.jpg", "--out", "x.glb"],
        ["sketch"],
        ["sketch", "front.json"],
        ["sketch", "--out", "x.glb"],
        ["sketch", "front.json", "side.json", "back.json", "--out", "x.glb"],
        ["sketch", "front.json", "--strokes", "s.json", "--out", "x.glb"],
        ["sketch", "a.treestroke", "side.json", "--out", "x.glb"],
        ["sketch", "a.treestroke", "--photo", "b.jpg", "--out", "x.glb"],
        ["sketch", "missing.json", "--out", "x.glb"],
        ["sketch", "missing.treestroke", "--out", "x.glb"],
        ["views"],
        ["views", "a.jpg", "b.jpg"],
        ["views", "a.jpg", "b.jpg", "--out", "x.glb"],
        ["views", "a.jpg", "b/a.jpg", "--strokes", "v.json", "--out", "x.glb"],
        ["views", "missing", "--strokes", "v.json", "--out", "x.glb"],
        ["views", "missing.treestroke", "--out", "x.glb"],
        ["views", "a.treestroke", "--strokes", "v.json", "--out", "x.glb"],
        ["trace", "photo.jpg"],
        ["trace", "photo.jpg", "--strokes", "s.json", "--seed", "1"],
    ],
)
def test_wrong_usage_is_one_line_and_exit_2(argv: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(argv) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert len(said.err.splitlines()) == 1
    assert said.err.startswith("treestroke: ")


@pytest.mark.parametrize(
    ("flags", "name"),
    [
        (["--height", "0"], "height"),
        (["--height", "tall"], "height"),
        (["--height", "nan"], "height"),
        (["--iterations", "2.5"], "iterations"),
        (["--iterations", "2001"], "iterations"),
        (["--library", "type3"], "library"),
        (["--foliage", "moss"], "foliage"),
        (["--leaf-size", "0.1"], "leaf_size"),
        (["--leaf_density", "4"], "leaf_density"),
        (["--variants", "0"], "variants"),
        (["--species", "palm"], "species"),
        (["--season", "winter"], "season"),
        (["--wind", "storm"], "wind"),
        (["--lod", "yes"], "lod"),
        (["--files", "obj,fbx"], "files"),
        (["--seed", "-1"], "seed"),
        (["--seed", "9223372036854775808"], "seed"),
        (["--seed", "1.5"], "seed"),
    ],
)
def test_a_setting_out_of_range_is_refused_by_name(run, flags: list[str], name: str) -> None:
    code, lines, left = run(*flags)
    assert (code, left) == (2, [])
    assert len(lines) == 1
    assert f"treestroke: {name}: " in lines[0]


@pytest.mark.parametrize("photo", ["missing.jpg", ".", "SOURCES.md"])
def test_a_photo_that_cannot_be_read_is_refused(run, maple_photo: Path, photo: str) -> None:
    code, lines, left = run(photo=maple_photo.parent / photo)
    assert (code, len(lines), left) == (2, 1, [])
    assert photo in lines[0] or "examples" in lines[0]


@pytest.mark.parametrize(
    ("image", "ending"),
    [
        (Image.new("RGB", (63, 200)), "png"),
        (Image.new("L", (16_400, 64)), "png"),
        (Image.new("1", (8_000, 6_300)), "png"),
        (Image.new("RGB", (200, 200)), "gif"),
        (Image.new("RGB", (16_400, 200)), "tiff"),
    ],
)
def test_a_photo_out_of_bounds_is_refused(run, tmp_path: Path, image: Image.Image, ending: str) -> None:
    code, lines, left = run(photo=picture_file(tmp_path, image, ending))
    assert (code, len(lines), left) == (2, 1, [])


def test_a_photo_cut_short_is_refused(run, tmp_path: Path, maple_photo: Path) -> None:
    short = tmp_path.parent / f"{tmp_path.name}.jpg"
    short.write_bytes(maple_photo.read_bytes()[:50_000])
    code, lines, left = run(photo=short)
    assert (code, len(lines), left) == (2, 1, [])


def test_a_photo_that_lacks_its_last_bytes_gives_its_tree_and_a_line_that_says_so(
    run, tmp_path: Path, maple_photo: Path
) -> None:
    short, report = (tmp_path.parent / f"{tmp_path.name}.{ending}" for ending in ("jpg", "json"))
    short.write_bytes(maple_photo.read_bytes()[:-2])
    code, (line,), left = run("--report", str(report), photo=short)
    assert (code, left) == (0, ["tree.glb"])
    tree = (tmp_path / "tree.glb").read_bytes()
    (warning,) = json.loads(report.read_text())["warnings"]
    assert (warning["code"], warning["stroke"]) == ("photo_cut_short", "photo")
    assert line == f"treestroke: photo: {warning['detail']}"
    assert run(photo=maple_photo)[0] == 0
    assert (tmp_path / "tree.glb").read_bytes() == tree


def test_trace_tells_of_a_photo_that_lacks_its_last_bytes(
    tmp_path: Path, maple_photo: Path, maple_strokes: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    short = tmp_path / "short.jpg"
    short.write_bytes(maple_photo.read_bytes()[:-2])
    assert main(["trace", str(short), "--strokes", str(maple_strokes)]) == 0
    told = capsys.readouterr()
    assert [one["code"] for one in json.loads(told.out)["warnings"]] == ["photo_cut_short"]
    assert "cut short" in told.err


@pytest.mark.parametrize("ending", ["heic", "avif", "tiff"])
def test_a_photo_of_a_phone_or_a_scanner_becomes_a_tree(run, tmp_path: Path, maple_photo: Path, ending: str) -> None:
    photo = tmp_path.parent / f"{tmp_path.name}.{ending}"
    photo.write_bytes(saved(Image.open(maple_photo), "HEIF" if ending == "heic" else ending.upper()))
    code, lines, left = run(photo=photo)
    assert (code, lines, left) == (0, [], ["tree.glb"])


def test_a_damaged_tiff_is_one_line_whatever_its_library_prints(tmp_path: Path, maple_strokes: Path) -> None:
    photo = tmp_path / "tree.tif"
    image = Image.effect_noise((200, 200), 90)
    damaged = bytearray(saved(image, "TIFF", compression="tiff_lzw"))
    damaged[3000:9000] = b"\x55" * 6000
    photo.write_bytes(damaged)
    command = [sys.executable, "-m", "treestroke", "trace", str(photo), "--strokes", str(maple_strokes)]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ended.returncode == 2
    (line,) = ended.stderr.splitlines()
    assert line.startswith(f"treestroke: {photo}: the photo is damaged or cut short")


LINE = [[340, 580], [345, 300]]


@pytest.mark.parametrize(
    ("changes", "where"),
    [
        ({"crown": {"points": [[0, 0], [1, 1]]}}, "crown"),
        ({"crown": {"points": [[0, 0], [9, 0], [9, 9]]}}, "crown"),
        ({"crown": {"points": [[0, 0], [float("nan"), 0], [9, 9]]}}, "NaN"),
        ({"crown": None}, "crown"),
        ({"leaves": []}, "leaves"),
        ({"branches": []}, "branches"),
        ({"branches": [{"points": [[340, 580], [340, 580]]}]}, "branches/0"),
        ({"branches": [{"points": [[340, 580], ["a", 0]]}]}, "branches/0"),
        ({"branches": [{"points": [[2, 580], [1, 599]]}]}, "branches/0"),
        ({"branches": [{"points": LINE}] * 200}, "at most 199"),
        ({"branches": [{"points": LINE * 5_001}]}, "branches/0"),
        ({"branches": [{"points": LINE, "colour": "red"}]}, "colour"),
    ],
)
def test_strokes_that_describe_no_tree_are_refused(
    run, tmp_path: Path, maple_strokes: Path, changes: dict, where: str
) -> None:
    code, lines, left = run(strokes=strokes_file(tmp_path, maple_strokes, **changes))
    assert (code, len(lines), left) == (2, 1, [])
    assert where in lines[0]


def test_a_stroke_file_that_is_missing_or_no_json_is_refused(run, tmp_path: Path, maple_photo: Path) -> None:
    for strokes in (tmp_path / "missing.json", maple_photo):
        code, lines, left = run(strokes=strokes)
        assert (code, len(lines), left) == (2, 1, [])


@pytest.mark.parametrize("out", ["missing/tree.glb", "."])
def test_a_place_that_no_file_can_have_is_refused(run, out: str) -> None:
    code, lines, left = run(out=out)
    assert (code, len(lines), left) == (2, 1, [])


def test_an_input_is_not_written_over(run, tmp_path: Path, maple_photo: Path) -> None:
    copy = tmp_path / "photo.jpg"
    copy.write_bytes(maple_photo.read_bytes())
    code, lines, left = run(photo=copy, out="photo.jpg")
    assert (code, len(lines), left) == (2, 1, ["photo.jpg"])
    assert copy.read_bytes() == maple_photo.read_bytes()


def test_a_model_is_written_with_report_and_preview(run, tmp_path: Path) -> None:
    code, lines, left = run("--report", str(tmp_path / "r.json"), "--preview", str(tmp_path / "p.png"), "--seed", "3")
    assert (code, lines, left) == (0, [], ["p.png", "r.json", "tree.glb"])
    assert (tmp_path / "tree.glb").read_bytes()[:4] == b"glTF"
    report = json.loads((tmp_path / "r.json").read_text())
    assert report["seed"] == 3
    assert report["settings"]["iterations"] == 5
    assert report["counts"]["bytes"] == (tmp_path / "tree.glb").stat().st_size
    assert decode_photo((tmp_path / "p.png").read_bytes(), "preview").shape[0] == 620


def test_command_line_and_library_give_the_same_bytes(
    run, tmp_path: Path, maple_photo: Path, maple_strokes: Path
) -> None:
    run("--leaf-size", "1.5")
    by_library = treestroke.model(maple_photo.read_bytes(), maple_strokes, {"leaf_size": 1.5, "iterations": 5})
    assert (tmp_path / "tree.glb").read_bytes() == by_library.glb


def test_a_project_file_gives_the_same_bytes(run, tmp_path: Path, maple_photo: Path, maple_strokes: Path) -> None:
    project = tmp_path / "maple.treestroke"
    with zipfile.ZipFile(project, "w") as archive:
        archive.write(maple_photo, "photo.jpg")
        archive.write(maple_strokes, "strokes.json")
        archive.writestr("settings.json", json.dumps({"iterations": 5, "seed": 4}))
    assert main(["model", str(project), "--out", str(tmp_path / "a.glb")]) == 0
    run("--seed", "4")
    assert (tmp_path / "a.glb").read_bytes() == (tmp_path / "tree.glb").read_bytes()


def test_the_bytes_do_not_depend_on_the_number_of_threads(
    tmp_path: Path, maple_photo: Path, maple_strokes: Path
) -> None:
    trees = []
    for threads in ("1", "4"):
        out = tmp_path / f"{threads}.glb"
        argv = ["model", str(maple_photo), "--strokes", str(maple_strokes), "--out", str(out), *QUICK]
        many = {"OMP_NUM_THREADS": threads, "OPENBLAS_NUM_THREADS": threads, "OPENCV_FOR_THREADS_NUM": threads}
        env = os.environ | many | {"PYTHONPATH": str(Path(treestroke.__file__).parents[1])}
        subprocess.run([sys.executable, "-m", "treestroke", *argv], env=env, check=True, timeout=600)
        trees.append(out.read_bytes())
    assert trees[0] == trees[1]


def test_trace_answers_in_the_contract_s_shape(tmp_path: Path, maple_photo: Path, maple_strokes: Path) -> None:
    out, overlay = tmp_path / "t.json", tmp_path / "o.png"
    argv = ["trace", str(maple_photo), "--strokes", str(maple_strokes), "--out", str(out), "--overlay", str(overlay)]
    assert main(argv) == 0
    answer = json.loads(out.read_text())
    assert set(answer) == {"foliage", "skeleton", "warnings", "taken"}
    skeleton = answer["skeleton"]
    assert {len(skeleton[key]) for key in ("points", "radii", "parents", "stroke")} == {len(skeleton["points"])}
    assert decode_photo(overlay.read_bytes(), "overlay").shape == decode_photo(maple_photo.read_bytes(), "photo").shape


def test_trace_without_out_prints_its_answer(
    tmp_path: Path, maple_photo: Path, maple_strokes: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    strokes = strokes_file(tmp_path, maple_strokes, branches=[])
    assert main(["trace", str(maple_photo), "--strokes", str(strokes)]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["foliage"]
    assert answer["skeleton"]["points"] == []


def test_a_full_disk_is_exit_1_and_leaves_the_old_file_whole(run, tmp_path: Path) -> None:
    (tmp_path / "tree.glb").write_bytes(b"old")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, before[1]))
    try:
        code, lines, left = run()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, handler)
    assert (code, len(lines), left) == (1, 1, ["tree.glb"])
    assert (tmp_path / "tree.glb").read_bytes() == b"old"


@pytest.mark.parametrize("why", ["slow", "memory", "crash"])
def test_cameras_that_the_machine_could_not_find_are_exit_1(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, why: Any
) -> None:
    def end(*_: object) -> NoReturn:
        raise SolveEnded(why)

    monkeypatch.setattr("treestroke.service.model.solve_in_process", end)
    for name, shot in zip(walked_capture.names(), walked_capture.shots(), strict=True):
        (tmp_path / name).write_bytes(encode_png(shot.picture))
    (tmp_path / "views.json").write_text(json.dumps(walked_capture.views()))
    argv = ["views", str(tmp_path), "--strokes", str(tmp_path / "views.json"), "--out", str(tmp_path / "tree.glb")]
    assert main(argv) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("treestroke: ")
    assert str(SolveEnded(why)) in line
    assert not (tmp_path / "tree.glb").exists()


def test_a_full_device_is_exit_1(maple_photo: Path, maple_strokes: Path, capsys: pytest.CaptureFixture[str]) -> None:
    argv = ["model", str(maple_photo), "--strokes", str(maple_strokes), "--out", "/dev/full", *QUICK]
    assert main(argv) == 1
    assert len(capsys.readouterr().err.splitlines()) == 1
    assert Path("/dev/full").is_char_device()


def test_debug_shows_the_trace(maple_photo: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["trace", str(maple_photo), "--strokes", "missing.json", "--debug"]) == 2
    assert "Traceback" in capsys.readouterr().err


def test_an_interrupt_is_exit_130_and_leaves_nothing(run) -> None:
    before = signal.signal(signal.SIGALRM, signal.default_int_handler)
    signal.setitimer(signal.ITIMER_REAL, 0.02)
    try:
        code, lines, left = run("--iterations", "2000")
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    assert (code, len(lines), left) == (130, 1, [])


def test_further_files_lie_beside_out_and_begin_with_its_name(run) -> None:
    code, lines, left = run("--files", "swc, csv", "--variants", "2", out="oak.glb")
    assert (code, lines) == (0, [])
    each = ["glb", "skeleton.csv", "swc"]
    assert left == sorted([f"oak.{end}" for end in each] + [f"oak.v2.{end}" for end in each])


def test_files_of_one_format_name_each_other_by_their_own_names(run, tmp_path: Path) -> None:
    assert run("--files", "gltf,obj", out="oak.glb")[0] == 0
    loose = json.loads((tmp_path / "oak.gltf").read_text())
    named = [loose["buffers"][0]["uri"], *(image["uri"] for image in loose["images"])]
    assert named[0] == "oak.bin"
    assert all((tmp_path / name).is_file() for name in named)
    assert (tmp_path / "oak.obj").read_text().startswith("mtllib oak.mtl\n")


def test_a_file_is_compressed_where_that_is_asked_for(run, tmp_path: Path) -> None:
    sizes = []
    for flags in ([], ["--no-compress"], ["--compress"]):
        assert run(*flags)[0] == 0
        sizes.append((tmp_path / "tree.glb").stat().st_size)
    assert sizes[0] == sizes[1]
    assert sizes[2] < 0.4 * sizes[0]


def test_no_further_file_is_written_over_what_was_read(run, tmp_path: Path, maple_strokes: Path) -> None:
    strokes = tmp_path / "tree.skeleton.json"
    strokes.write_bytes(maple_strokes.read_bytes())
    code, lines, left = run("--files", "json", strokes=strokes)
    assert (code, left) == (2, ["tree.skeleton.json"])
    assert "choose another --out" in lines[0]
    assert strokes.read_bytes() == maple_strokes.read_bytes()


def test_a_leaf_that_cannot_be_used_is_refused_in_one_line(run, tmp_path: Path) -> None:
    opaque = picture_file(tmp_path, Image.new("RGB", (64, 64), "green"))
    for leaf, said in ((opaque, "cut the leaf out"), (tmp_path / "none.png", "no such file")):
        code, lines, left = run("--leaf", str(leaf))
        assert (code, left) == (2, [])
        assert len(lines) == 1
        assert said in lines[0]


def test_two_sketches_become_a_tree_with_all_its_files(draw, tmp_path: Path) -> None:
    report, preview = tmp_path / "report.json", tmp_path / "front.png"
    code, lines, left = draw("--report", str(report), "--preview", str(preview), "--seed", "3", "--height", "4")
    assert (code, lines, left) == (0, [], ["front.png", "report.json", "tree.glb"])
    told = json.loads(report.read_text())
    assert (told["seed"], told["settings"]["height"], told["warnings"]) == (3, 4.0, [])
    assert told["score"]["side_covered"] > 0.9
    assert {"decode", "trace", "lift", "grow", "leaf", "mesh", "write"} == set(told["seconds"])
    settings = {"height": 4, "iterations": 5, "leaf_density": 0.2}
    assert (tmp_path / "tree.glb").read_bytes() == treestroke.sketch(sketched.FRONT, sketched.SIDE, settings, 3).glb


def test_one_sketch_alone_says_aloud_what_was_assumed(draw, tmp_path: Path) -> None:
    report = tmp_path / "report.json"
    code, lines, _ = draw("--report", str(report), views=("front",))
    assert code == 0
    assert len(lines) == 1
    assert lines[0].startswith("treestroke: side: there is no sketch of the left side")
    assert [warning["code"] for warning in json.loads(report.read_text())["warnings"]] == ["side_assumed"]


def test_sketches_may_be_pictures_over_a_photo(draw, tmp_path: Path) -> None:
    base = tmp_path.parent / tmp_path.name
    for name, content in (("a.png", sketched.png(sketched.FRONT)), ("b.png", drawn.encoded())):
        Path(f"{base}.{name}").write_bytes(content)
    code, lines, left = draw("--photo", f"{base}.b.png", views=(f"{base}.a.png", "side"))
    assert (code, lines, left) == (0, [], ["tree.glb"])


def test_a_fruit_is_borne_and_one_that_cannot_be_used_is_refused(draw, tmp_path: Path) -> None:
    berry = tmp_path.parent / f"{tmp_path.name}.berry.png"
    berry.write_bytes(sketched.berry())
    draw()
    plain = (tmp_path / "tree.glb").read_bytes()
    assert draw("--fruit", str(berry))[0] == 0
    assert (tmp_path / "tree.glb").read_bytes() != plain
    code, lines, _ = draw("--fruit", str(tmp_path / "none.png"))
    assert (code, len(lines), "no such file" in lines[0]) == (2, 1, True)


@pytest.mark.parametrize("content", [b"", b"{}", b"\x89PNG\r\n\x1a\n", b'{"branches": [{"points": [[1, 1], [1, 1]]}]}'])
def test_a_sketch_that_shows_no_tree_is_refused_in_one_line(draw, tmp_path: Path, content: bytes) -> None:
    other = tmp_path.parent / f"{tmp_path.name}.other.json"
    other.write_bytes(content)
    for views in ((str(other),), ("front", str(other))):
        code, lines, left = draw(views=views)
        assert (code, len(lines), left) == (2, 1, [])


def test_no_sketch_is_written_over(draw, tmp_path: Path) -> None:
    side = tmp_path.parent / f"{tmp_path.name}.side.json"
    code, lines, _ = draw("--report", str(side))
    assert (code, len(lines)) == (2, 1)
    assert json.loads(side.read_text()) == sketched.SIDE


def test_a_side_gives_a_photo_its_depth(run, tmp_path: Path) -> None:
    side, report = tmp_path.parent / f"{tmp_path.name}.side.json", tmp_path / "report.json"
    side.write_text(json.dumps(sketched.SIDE))
    assert run()[0] == 0
    plain = (tmp_path / "tree.glb").read_bytes()
    code, lines, _ = run("--side", str(side), "--report", str(report))
    assert (code, lines) == (0, [])
    assert (tmp_path / "tree.glb").read_bytes() != plain
    assert json.loads(report.read_text())["score"]["depth_over_width"] > 0


@pytest.mark.skipif(has_usd(), reason="usd-core is installed")
def test_usdz_says_at_once_what_it_needs(run) -> None:
    code, lines, left = run("--files", "usdz")
    assert (code, left) == (2, [])
    assert "make usd" in lines[0]


def test_a_project_of_many_photos_needs_no_search_for_cameras(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shots, _ = walk(5)
    drawn = strokes_on(shots[0])
    crown, trunk = ({"points": stroke.points.tolist()} for stroke in (drawn.crown, drawn.branches[0]))
    views = {"views": [{"photo": shots[0].name, "crown": crown, "branches": [trunk]}]}
    parts = {f"photos/{shot.name}": encode_png(shot.picture) for shot in shots}
    parts |= {"views": json.dumps(views).encode(), "structure": encode_structure(structure_of(shots))}
    project = tmp_path / "ash.treestroke"
    with project.open("wb") as file:
        write_project(file, {name: io.BytesIO(part) for name, part in parts.items()}, {"iterations": 5, "height": 4.5})
    report = tmp_path / "ash.json"
    assert main(["views", str(project), "--out", str(tmp_path / "ash.glb"), "--report", str(report)]) == 0
    told = json.loads(report.read_text())
    assert "solve" not in told["seconds"]
    assert told["seconds"]["mattes"] > 0
    assert [camera["photo"] for camera in told["cameras"]] == [shot.name for shot in shots]
    assert told["measures"]["height"]["value"] == pytest.approx(4.5, rel=0.1)
    assert (tmp_path / "ash.glb").read_bytes().startswith(b"glTF")
    assert capsys.readouterr().err == "treestroke: photos/shaken.jpg: shaken.jpg is blurred: take it again\n"


def test_a_folder_without_photos_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "notes.txt").write_text("an ash")
    assert main(["views", str(tmp_path), "--strokes", "v.json", "--out", str(tmp_path / "x.glb")]) == 2
    assert capsys.readouterr().err.startswith(f"treestroke: {tmp_path}: there is no photo in this folder")


def test_strokes_on_a_missing_photo_are_refused_before_cameras_are_sought(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "treestroke.engines.structure", None)
    for shot in walk(5)[0]:
        (tmp_path / shot.name).write_bytes(encode_png(shot.picture))
    views = tmp_path / "views.json"
    crown = {"points": [[10, 10], [90, 10], [90, 90]]}
    views.write_text(json.dumps({"views": [{"photo": "gone.jpg", "crown": crown}]}))
    assert main(["views", str(tmp_path), "--strokes", str(views), "--out", str(tmp_path / "x.glb")]) == 2
    assert "there is no photo gone.jpg; the photos are 0.jpg" in capsys.readouterr().err
