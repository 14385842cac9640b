import json
import re
from dataclasses import fields

import pytest
from tests.architecture.names import DOCUMENTS, ROOT

import treestroke
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.settings import PREFIX, Settings


def test_the_readme_s_settings_are_the_table() -> None:
    allowed = r"from .*?|a whole .*?|any of .*?|true or false|\w+, .*?"
    text = (ROOT / "README.md").read_text()
    rows = re.findall(rf"^\| `([a-z_]+)` \| (\S+) \| ({allowed}) \| (.*?) \|$", text, re.M)
    plain = {False: "false", (): "none"}
    table = [
        (
            f.name,
            f"{f.default:g}" if isinstance(f.default, float) else plain.get(f.default, str(f.default)),
            str(f.metadata["allowed"]),
            f.metadata["meaning"],
        )
        for f in fields(ModelSettings)
    ]
    assert rows == table


def test_the_readme_s_variables_are_the_service_s_settings() -> None:
    rows = re.findall(r"^\| `(TREESTROKE_\w+)` \| (\S+) \| (.*?) \|$", (ROOT / "README.md").read_text(), re.M)
    table = [
        (f"{PREFIX}{name.upper()}", str(field.default) or "empty", field.description)
        for name, field in Settings.model_fields.items()
    ]
    assert rows == table


@pytest.mark.parametrize("name", DOCUMENTS)
def test_every_link_leads_somewhere(name: str) -> None:
    document = ROOT / name
    links = re.findall(r"\]\(([^)#:]+)\)", document.read_text())
    assert [link for link in links if not (document.parent / link).exists()] == []


def test_every_make_target_is_documented() -> None:
    targets = re.findall(r"^([a-z]+): \$\(STAMP\)", (ROOT / "Makefile").read_text(), re.M)
    written = (ROOT / "README.md").read_text() + (ROOT / "CONTRIBUTING.md").read_text()
    assert [t for t in targets if t != "setup" and f"`make {t}`" not in written] == []


def test_every_example_has_strokes_and_a_source() -> None:
    photos = sorted((ROOT / "examples").glob("*.jpg"))
    sources = (ROOT / "examples" / "SOURCES.md").read_text()
    assert photos
    for photo in photos:
        assert json.loads(photo.with_suffix(".strokes.json").read_text())["branches"]
        assert f"| {photo.name} |" in sources


def test_every_test_photo_has_a_source() -> None:
    sources = (ROOT / "tests" / "data" / "SOURCES.md").read_text()
    photos = [p.name for p in (ROOT / "tests" / "data").glob("*.jpg")]
    assert [name for name in photos if f"| {name} |" not in sources] == []


def test_every_public_name_can_be_had() -> None:
    assert all(getattr(treestroke, name) is not None for name in treestroke.__all__)
