"""Dockerfile, docker-compose.yml and what it mounts, as far as they can be judged without a container engine."""

import json
import os
import re
import shutil
import subprocess
import sys
from contextlib import closing
from ipaddress import ip_address, ip_network
from pathlib import Path
from typing import Any

import boto3
import psycopg
import pytest
import yaml
from botocore.exceptions import ClientError
from psycopg.sql import SQL
from tests.bucket import S3Server
from tests.postgres import running_postgres

from treestroke.serve import STOP_SECONDS
from treestroke.settings import Settings, check_secret, read_settings
from treestroke.store.database import Database

ROOT = Path(__file__).parents[1]
DOCKERFILE = (ROOT / "Dockerfile").read_text().replace("\\\n", " ")
COMPOSE: dict[str, Any] = yaml.safe_load((ROOT / "docker-compose.yml").read_text())
SERVICES: dict[str, dict[str, Any]] = COMPOSE["services"]
OURS = ("web", "worker", "migrate", "bucket")
OWNER = "TREESTROKE_OWNER_DATABASE_URL"
DIGEST = r"@sha256:[0-9a-f]{64}"


def make_secrets(folder: Path) -> Path:
    subprocess.run(["sh", ROOT / "deploy" / "secrets.sh", folder / "secrets"], check=True, stderr=subprocess.DEVNULL)
    return folder / "secrets"


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


def test_only_the_proxy_is_reached_from_outside() -> None:
    assert [name for name, service in SERVICES.items() if "ports" in service or "network_mode" in service] == ["proxy"]
    assert {name for name, service in SERVICES.items() if "front" in service["networks"]} == {"proxy", "web"}
    assert COMPOSE["networks"]["back"] == {"internal": True}
    assert SERVICES["worker"]["networks"] == ["back"]


def test_the_web_process_believes_the_proxy_alone() -> None:
    address = SERVICES["proxy"]["networks"]["front"]["ipv4_address"]
    assert SERVICES["web"]["environment"]["TREESTROKE_PROXIES"] == address
    (network,) = COMPOSE["networks"]["front"]["ipam"]["config"]
    assert ip_address(address) in ip_network(network["subnet"])
    assert SERVICES["web"]["environment"]["TREESTROKE_HOSTS"] == SERVICES["proxy"]["environment"]["SITE"]


@pytest.mark.parametrize("name", SERVICES)
def test_every_service_is_bounded(name: str) -> None:
    service = SERVICES[name]
    assert service["read_only"] is True
    assert service["cap_drop"] == ["ALL"]
    assert service["security_opt"] == ["no-new-privileges:true"]
    assert service["mem_limit"]
    assert service["pids_limit"] > 0
    assert service["tmpfs"]
    assert [one for one in service["tmpfs"] if ":size=" not in one] == []
    assert set(service.get("cap_add", [])) <= ({"NET_BIND_SERVICE"} if name == "proxy" else set())
    assert service["logging"]["options"]["max-size"]


@pytest.mark.parametrize("name", SERVICES)
def test_every_service_that_stays_comes_back_and_says_whether_it_is_well(name: str) -> None:
    service = SERVICES[name]
    one_off = name in ("migrate", "bucket")
    assert service["restart"] == ("no" if one_off else "unless-stopped")
    # Of the web process the image tells, of workers the web process.
    assert ("test" in service.get("healthcheck", {})) == (name not in OURS)


@pytest.mark.parametrize("name", ["web", "worker"])
def test_it_can_be_scaled(name: str) -> None:
    service = SERVICES[name]
    assert {"container_name", "ports", "network_mode", "hostname"} & set(service) == set()
    assert service["volumes"] == ["/data"]  # one for each container: they share none
    assert int(service["stop_grace_period"].removesuffix("s")) > STOP_SECONDS


def test_web_and_workers_share_database_bucket_and_queue() -> None:
    web, worker = (SERVICES[name]["environment"] for name in ("web", "worker"))
    shared = ("TREESTROKE_BROKER_URL", "TREESTROKE_BUCKET_URL", "AWS_ENDPOINT_URL_S3", "AWS_SHARED_CREDENTIALS_FILE")
    assert [web[name] for name in shared] == [worker[name] for name in shared]
    assert web["TREESTROKE_WORKERS"] == "0"
    assert int(worker["TREESTROKE_WORKERS"]) > 0
    assert {"TREESTROKE_DATABASE_URL", "s3_service"} <= set(SERVICES["worker"]["secrets"])


def test_the_owner_of_the_tables_is_known_to_the_migration_alone() -> None:
    known = {name for name, service in SERVICES.items() if OWNER in service.get("secrets", [])}
    assert known == {"migrate"}
    assert [name for name, service in SERVICES.items() if "migrate" in service.get("depends_on", {})] == [
        "web",
        "worker",
    ]


def test_secrets_are_files_that_the_script_makes(tmp_path: Path) -> None:
    made = make_secrets(tmp_path)
    assert {one["file"] for one in COMPOSE["secrets"].values()} == {f"secrets/{path.name}" for path in made.iterdir()}
    assert set(COMPOSE["secrets"]) == {name for service in SERVICES.values() for name in service.get("secrets", [])}
    assert made.stat().st_mode & 0o777 == 0o700
    assert {path.stat().st_mode & 0o777 for path in made.iterdir()} == {0o644}  # users of containers read them
    before = {path.name: path.read_text() for path in made.iterdir()}
    assert {path.name: path.read_text() for path in make_secrets(tmp_path).iterdir()} == before
    assert "secrets/" in (ROOT / ".gitignore").read_text().splitlines()


def test_the_service_reads_the_secrets_that_were_made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = make_secrets(tmp_path)
    given = tmp_path / "given"
    given.mkdir()
    for name in SERVICES["web"]["secrets"]:
        shutil.copy(made / name, given / name)
    monkeypatch.setattr("treestroke.settings.SECRETS", given)
    settings = read_settings()
    check_secret(settings)
    assert re.fullmatch(r"postgresql:/{2}treestroke:[0-9a-f]{64}@postgres:5432/treestroke", settings.database_url)


def test_the_roles_are_an_owner_and_a_user_who_may_not_change_tables(tmp_path: Path) -> None:
    made = make_secrets(tmp_path)
    with running_postgres() as server:
        where = {"PGHOST": "127.0.0.1", "PGPORT": str(server.port), "SECRETS": str(made)}
        subprocess.run(["sh", ROOT / "deploy" / "roles.sh"], env={**os.environ, **where}, check=True)
        urls = {name: (made / name).read_text().strip() for name in (OWNER, "TREESTROKE_DATABASE_URL")}
        here = {name: url.replace("postgres:5432", f"127.0.0.1:{server.port}") for name, url in urls.items()}
        with closing(Database(tmp_path, here[OWNER])) as database:
            database.migrate()
        with pytest.raises(psycopg.errors.InsufficientPrivilege):
            server.execute(SQL("CREATE TABLE mine ()"), here["TREESTROKE_DATABASE_URL"])


def test_the_bucket_is_made_and_the_service_may_use_it_and_no_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = make_secrets(tmp_path)
    server = S3Server(tmp_path / "s3", json.loads((made / "s3_keys").read_text())["identities"])
    try:
        monkeypatch.setenv("AWS_ENDPOINT_URL_S3", server.environment["AWS_ENDPOINT_URL_S3"])
        monkeypatch.setenv("AWS_DEFAULT_REGION", "us-east-1")
        monkeypatch.setenv("AWS_SHARED_CREDENTIALS_FILE", str(made / "s3_admin"))
        for _ in range(2):
            subprocess.run([sys.executable, *SERVICES["bucket"]["command"][1:]], check=True)
        monkeypatch.setenv("AWS_SHARED_CREDENTIALS_FILE", str(made / "s3_service"))
        client = boto3.session.Session().client("s3")
        client.put_object(Bucket="treestroke", Key="blobs/one", Body=b"one")
        assert client.get_object(Bucket="treestroke", Key="blobs/one")["Body"].read() == b"one"
        client.delete_object(Bucket="treestroke", Key="blobs/one")
        with pytest.raises(ClientError, match="AccessDenied"):
            client.create_bucket(Bucket="other")
    finally:
        server.kill()


def test_every_setting_that_is_given_exists() -> None:
    scripts = "".join((ROOT / "deploy" / name).read_text() for name in ("secrets.sh", "roles.sh", "Caddyfile"))
    given = set(re.findall(r"TREESTROKE_\w+", DOCKERFILE + (ROOT / "docker-compose.yml").read_text() + scripts))
    assert given <= {f"TREESTROKE_{name.upper()}" for name in Settings.model_fields}


def test_every_image_has_a_version_and_those_of_others_a_digest() -> None:
    images = [line.split()[0] for line in lines("FROM")] + [service["image"] for service in SERVICES.values()]
    ours = {SERVICES[name]["image"] for name in OURS}
    assert [image for image in images if not re.search(r":\d", image) or image.endswith(":latest")] == []
    assert [image for image in images if image not in ours and not re.search(f"{DIGEST}$", image)] == []


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
