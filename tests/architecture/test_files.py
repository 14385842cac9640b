import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PATH_OF_A_MACHINE = re.compile(r"(?<![\w.])/(?:work|root|home|opt|Users|mnt|srv)/\w|\.\./shared|[A-Z]:\\\\")
NAMESPACE = re.compile(r"\bhttp:/{2}www\.w3\.org/\d{4}/[\w/]+")
"""A name that looks like an address and that nobody asks for."""
OWN = r"(?:127\.0\.0\.1|localhost|\[::1\]|redis|s3|testserver|treestroke|treestroke_owner)\b"
"""This machine, and the names in docker-compose.yml."""
HOST = re.compile(rf"\b\w+:/{{2}}(?!{OWN}|HOST\b|BUCKET\b|USER\b)\w[\w.-]*|\b(?:pypi|pythonhosted|npmjs)\.org")


def tracked() -> list[Path]:
    if shutil.which("git") is None or not (ROOT / ".git").exists():
        pytest.skip("the files are not in a git repository")
    listed = subprocess.run(
        ["git", "ls-files", "-co", "--exclude-standard", "-z"], cwd=ROOT, capture_output=True, check=True
    )
    return [ROOT / name for name in listed.stdout.decode().split("\0") if name and (ROOT / name).is_file()]


def texts() -> dict[str, str]:
    found = {}
    for path in tracked():
        data = path.read_bytes()
        if b"\0" not in data:
            found[str(path.relative_to(ROOT))] = data.decode("utf-8", errors="replace")
    return found


def test_no_file_names_a_path_of_a_machine() -> None:
    assert {name: hit.group() for name, text in texts().items() if (hit := PATH_OF_A_MACHINE.search(text))} == {}


def test_no_file_but_a_document_names_a_host() -> None:
    named = {
        name: hit.group()
        for name, text in texts().items()
        if (hit := HOST.search(NAMESPACE.sub("", text))) and not name.endswith(".md")
    }
    assert named == {}


def test_every_requirement_is_pinned_by_hash() -> None:
    for name in ("requirements.txt", "requirements-dev.txt"):
        entries = (ROOT / name).read_text().replace("\\\n", " ").splitlines()
        assert entries
        assert [entry for entry in entries if "==" not in entry or "--hash=sha256:" not in entry] == []


def test_what_runs_is_pinned_alike_for_running_and_for_work() -> None:
    run, work = ((ROOT / name).read_text() for name in ("requirements.txt", "requirements-dev.txt"))
    assert set(re.findall(r"^\S+==\S+", run, re.M)) <= set(re.findall(r"^\S+==\S+", work, re.M))


def test_every_package_of_the_page_is_pinned_by_hash_and_comes_from_no_given_place() -> None:
    packages = json.loads((ROOT / "frontend" / "package-lock.json").read_text())["packages"]
    packages.pop("")
    assert packages
    assert [name for name, one in packages.items() if not one["integrity"].startswith("sha512-")] == []
    assert [name for name, one in packages.items() if {"resolved", "funding"} & set(one)] == []  # `npm run lock`


def test_the_page_s_own_packages_have_one_version_each() -> None:
    given = json.loads((ROOT / "frontend" / "package.json").read_text())
    versions = {**given["dependencies"], **given["devDependencies"]}
    assert [name for name, version in versions.items() if not re.fullmatch(r"\d+\.\d+\.\d+", version)] == []
