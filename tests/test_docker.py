"""Dockerfile and docker-compose.yml, as far as they can be judged without building."""

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

from treestroke.settings import Settings

ROOT = Path(__file__).parents[1]
DOCKERFILE = (ROOT / "Dockerfile").read_text().replace("\\\n", " ")
COMPOSE: dict[str, Any] = yaml.safe_load((ROOT / "docker-compose.yml").read_text())
SERVICES: dict[str, dict[str, Any]] = COMPOSE["services"]
OURS = ("web", "worker")


def lines(instruction: str) -> list[str]:
    return re.findall(rf"^{instruction}\s+(.*)$", DOCKERFILE, re.M)


def test_compose_file_is_valid() -> None:
    # The schema is part of the package.
    command = [sys.executable, "-m", "check_jsonschema", "--builtin-schema", "vendor.compose-spec"]
    done = subprocess.run([*command, str(ROOT / "docker-compose.yml")], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_redis_keeps_its_queue_and_drops_none_of_it() -> None:
    command = SERVICES["redis"]["command"]
    options = dict(zip(command[1::2], command[2::2], strict=True))
    assert options["--appendonly"] == "yes"
    assert options["--maxmemory-policy"] == "noeviction"
    assert re.fullmatch(r"\d+mb", options["--maxmemory"])
    assert any(volume.endswith(":/data") for volume in SERVICES["redis"]["volumes"])


def test_nothing_is_published_beyond_this_machine() -> None:
    published = [port for service in SERVICES.values() for port in service.get("ports", [])]
    assert published == ["127.0.0.1:6379:6379"]
    assert [name for name, service in SERVICES.items() if service.get("network_mode") == "host"] == ["web"]


def test_the_worker_can_be_scaled() -> None:
    worker = SERVICES["worker"]
    assert {"container_name", "ports", "network_mode", "hostname"} & set(worker) == set()
    assert SERVICES["web"]["environment"]["TREESTROKE_WORKERS"] == "0"
    assert worker["command"] == ["treestroke", "worker"]


@pytest.mark.parametrize("name", OURS)
def test_web_and_worker_share_the_data_and_come_back(name: str) -> None:
    service = SERVICES[name]
    assert service["volumes"] == ["data:/data"]
    assert service["restart"] == "unless-stopped"
    assert int(service["stop_grace_period"].removesuffix("s")) > 10


def test_web_and_worker_use_the_same_redis() -> None:
    port = SERVICES["redis"]["ports"][0].split(":")[1]
    urls = [SERVICES[name]["environment"]["TREESTROKE_BROKER_URL"] for name in OURS]
    assert urls == [f"redis://127.0.0.1:{port}/0", "redis://redis:6379/0"]


def test_every_setting_that_is_given_exists() -> None:
    given = set(re.findall(r"TREESTROKE_\w+", DOCKERFILE + (ROOT / "docker-compose.yml").read_text()))
    assert given <= {f"TREESTROKE_{name.upper()}" for name in Settings.model_fields}


def test_every_image_has_a_version() -> None:
    images = [line.split()[0] for line in lines("FROM")] + [service["image"] for service in SERVICES.values()]
    assert [image for image in images if not re.search(r":\d", image) or image.endswith(":latest")] == []


def test_the_image_has_the_version_of_treestroke() -> None:
    import treestroke

    assert {SERVICES[name]["image"] for name in OURS} == {f"treestroke:{treestroke.__version__}"}


def test_every_copied_file_is_there_and_not_ignored() -> None:
    let_in = (ROOT / ".dockerignore").read_text().splitlines()
    sources = [source for line in lines("COPY") if "--from" not in line for source in line.split()[:-1]]
    assert len(sources) == 12
    missing = [one for one in sources if not (ROOT / one).exists()]
    kept_out = [one for one in sources if f"!{one.split('/')[0]}" not in let_in or one in let_in]
    assert (missing, kept_out) == ([], [])


def test_the_page_is_built_before_the_package_is() -> None:
    steps = [DOCKERFILE.index(step) for step in ("npm ci", "vite build", "COPY --from=page", "pip wheel")]
    assert steps == sorted(steps)
    ignored = (ROOT / ".dockerignore").read_text().splitlines()
    assert {"frontend/node_modules", "backend/treestroke/api/page"} <= set(ignored)


def test_what_runs_is_no_root_and_has_no_compiler() -> None:
    last = DOCKERFILE[DOCKERFILE.rindex("\nFROM ") :]
    user, command = (re.findall(rf"^{name} (.*)$", last, re.M) for name in ("USER", "CMD"))
    assert user == ["treestroke"]
    assert command == ['["treestroke", "serve"]']
    assert "gcc" not in last
    assert "--require-hashes" in DOCKERFILE


def test_the_health_check_is_python() -> None:
    (check,) = lines("HEALTHCHECK")
    code = yaml.safe_load(check.split("CMD ", 1)[1])[-1]
    compile(code, "HEALTHCHECK", "exec")
    assert "/livez" in code
