"""Settings of the service, read once from environment variables."""

import os
import re
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Literal
from urllib.parse import urlsplit

from pydantic import Field, ValidationError
from pydantic_settings import BaseSettings, SettingsConfigDict

from treestroke.core.errors import SettingsError, shown

PREFIX = "TREESTROKE_"
SECRETS = Path("/run/secrets")
"""Folder of files that are called as variables are: so containers are given secrets."""
_POSTGRES = ("postgresql://", "postgres://")
CLIENT_VARIABLES = ("TREESTROKE_KEY",)
"""Variables with the same prefix that are not the service's but its clients'."""
_SECRET_CHARACTERS = 32
_BUCKET = re.compile(r"s3://[a-z0-9][a-z0-9.-]{1,61}[a-z0-9](/[\w.=-]+)*/?")
LOOPBACK = ("127.0.0.1", "localhost", "::1")
PHOTO_MB, PHOTOS_MB = 120, 20_000


def _setting(default: object, meaning: str, **bounds: float) -> object:
    return Field(default, description=meaning, **bounds)  # type: ignore[call-overload]


class Settings(BaseSettings):
    """Settings of a deployment; each field is an environment variable with the prefix ``TREESTROKE_``."""

    model_config = SettingsConfigDict(env_prefix=PREFIX, env_ignore_empty=True, frozen=True, allow_inf_nan=False)

    data: Annotated[Path, _setting(Path("~/.treestroke"), "folder of the database, the files and the embedded queue")]
    host: Annotated[str, _setting("127.0.0.1", "address that the web process listens on")]
    port: Annotated[int, _setting(8000, "port that it listens on; 0 takes a free one", ge=0, le=65535)]
    metrics_port: Annotated[
        int, _setting(0, "port on which GET /metrics is answered to whoever reaches it; 0: none", ge=0, le=65535)
    ]
    database_url: Annotated[str, _setting("", "a Postgres (postgresql://...); empty: SQLite in the data folder")]
    owner_database_url: Annotated[
        str, _setting("", "the same Postgres by its tables' owner, who alone makes and changes them")
    ]
    hosts: Annotated[str, _setting("", "names that it answers to beside 127.0.0.1, with commas between")]
    proxies: Annotated[str, _setting("", "addresses of proxies before it that are trusted, with commas between")]
    secret: Annotated[str, _setting("", "at least 32 characters, by which keys are digested")]
    oidc_issuer: Annotated[str, _setting("", "an issuer to sign in at (https://...); empty: by a key alone")]
    oidc_client: Annotated[str, _setting("", "id by which the issuer knows this service")]
    oidc_client_secret: Annotated[str, _setting("", "the secret that goes with it; empty: a public client")]
    oidc_team: Annotated[str, _setting("", "team that whoever is new at the issuer joins; empty: nobody new may")]
    oidc_role: Annotated[Literal["viewer", "member"], _setting("member", "role of whoever joins so: viewer or member")]
    broker_url: Annotated[str, _setting("", "a Redis to queue on (redis://...); empty: files in the data folder")]
    bucket_url: Annotated[str, _setting("", "a bucket for the files (s3://BUCKET/PREFIX); empty: the data folder")]
    workers: Annotated[
        int,
        _setting(1, "jobs that a worker does at once; 0: `treestroke serve` starts no worker", ge=0, le=256),
    ]
    tracers: Annotated[int, _setting(2, "processes that decode photos and trace", ge=1, le=64)]
    trace_seconds: Annotated[
        float, _setting(20, "a tracing or decoding that takes longer is stopped, in seconds", gt=0, le=600)
    ]
    capture_trace_seconds: Annotated[
        float, _setting(300, "tracing a capture or a clip is stopped if it takes longer, in seconds", gt=0, le=3600)
    ]
    model_seconds: Annotated[float, _setting(300, "a model that takes longer fails, in seconds", gt=0, le=86_400)]
    solve_seconds: Annotated[
        float, _setting(600, "finding a capture's cameras fails if it takes longer, in seconds", gt=0, le=86_400)
    ]
    memory_mb: Annotated[
        int, _setting(4096, "address space of one tracing or growing process, in MB", ge=1024, le=2**20)
    ]
    photo_mb: Annotated[
        int,
        _setting(PHOTO_MB, "a photo that takes more as it is kept (PNG) is refused, in MB", ge=1, le=2**20),
    ]
    photos_mb: Annotated[
        int,
        _setting(PHOTOS_MB, "what all photos and clips may take, deleted ones for a day too, in MB", ge=1, le=2**20),
    ]
    team_stored_mb: Annotated[
        int, _setting(20_000, "what a team's photos, clips and files may take, in MB; 0: no limit", ge=0, le=2**30)
    ]
    team_queued: Annotated[
        int, _setting(50, "models and captures of a team that may wait; 0: no limit", ge=0, le=1_000_000)
    ]
    team_running: Annotated[
        int, _setting(2, "jobs of one team that are done at once where teams share it; 0: any number", ge=0, le=10_000)
    ]
    team_models_a_day: Annotated[
        int, _setting(500, "models that a team may ask for in 24 hours; 0: no limit", ge=0, le=1_000_000)
    ]
    keep_days: Annotated[
        float,
        _setting(0, "models, photos, captures and clips older than this are deleted; 0 keeps them", ge=0, le=36_500),
    ]

    @property
    def folder(self) -> Path:
        """Absolute path of the data folder."""
        return self.data.expanduser().absolute()

    @property
    def hosted(self) -> bool:
        """Whether several machines and teams may share the service: with a database of its own."""
        return bool(self.database_url)

    @property
    def most_running(self) -> int:
        """Jobs of one team that are done at once; 0: any number, as where one person has it all."""
        return self.team_running if self.hosted else 0

    @property
    def embedded(self) -> bool:
        """Whether the queue is a folder rather than a Redis."""
        return not self.broker_url

    @property
    def host_names(self) -> list[str]:
        """Names that the service answers to beside those of this machine."""
        return _names(self.hosts)

    @property
    def trusted_proxies(self) -> list[str]:
        """Addresses or networks of proxies that say who asks."""
        return _names(self.proxies)

    def environment(self) -> dict[str, str]:
        """Return the environment variables from which another process reads the same settings."""
        return {_variable(name): str(value) for name, value in self}


def read_settings(**flags: object) -> Settings:
    """Return the settings from the environment, or from files of `SECRETS`; ``flags`` take precedence.

    Raises
    ------
    SettingsError
        A variable, a file or a flag has a value that is not allowed, a variable or file with the prefix is not a
        setting, or a file cannot be read.
    """
    known = {_variable(name) for name in Settings.model_fields}
    for name in sorted({*os.environ, *_secret_files()}):
        if name.upper().startswith(PREFIX) and name.upper() not in {*known, *CLIENT_VARIABLES}:
            raise SettingsError(f"{name}: there is no such setting; the settings are {', '.join(sorted(known))}")
    try:
        folder = SECRETS if _secret_files() else None  # pydantic warns of a folder that is missing
        settings = Settings(**flags, _secrets_dir=folder)  # type: ignore[arg-type, call-arg]
        settings.folder  # noqa: B018 - raises if the home folder is unknown
    except ValidationError as error:
        first = error.errors()[0]
        name = str(first["loc"][0])
        where = f"--{name}" if name in flags else _variable(name)
        raise SettingsError(f"{where}: {shown(first['input'])} is not allowed; {_allowed(first['msg'])}") from None
    except OSError as error:
        raise SettingsError(f"{error.filename}: {error.strerror}; let the user of treestroke read it") from None
    except RuntimeError:
        raise SettingsError(
            "the user's home folder is unknown; name a data folder by --data or TREESTROKE_DATA"
        ) from None
    if not settings.embedded and not settings.broker_url.startswith(("redis://", "rediss://")):
        raise SettingsError(
            f"{_variable('broker_url')}: only Redis is supported; give redis://HOST:PORT/0, or leave it out"
        )
    if settings.hosted and not settings.database_url.startswith(_POSTGRES):
        raise SettingsError(
            f"{_variable('database_url')}: only Postgres is supported; give postgresql://HOST:PORT/NAME, "
            "or leave it out"
        )
    if settings.owner_database_url and not (settings.hosted and settings.owner_database_url.startswith(_POSTGRES)):
        raise SettingsError(
            f"{_variable('owner_database_url')}: it goes with {_variable('database_url')}, as the same Postgres by "
            "another user; give postgresql://USER@HOST:PORT/NAME, or leave it out"
        )
    if settings.bucket_url and not _BUCKET.fullmatch(settings.bucket_url):
        raise SettingsError(
            f"{_variable('bucket_url')}: {shown(settings.bucket_url)} names no bucket; give s3://BUCKET/PREFIX, or "
            "leave it out"
        )
    _check_oidc(settings)
    return settings


def _check_oidc(settings: Settings) -> None:
    """Check that people can sign in at an issuer, where there is to be one."""
    if not settings.oidc_issuer:
        return
    where = _variable("oidc_issuer")
    if not is_secure(settings.oidc_issuer) or {"?", "#"} & set(settings.oidc_issuer):
        raise SettingsError(
            f"{where}: {shown(settings.oidc_issuer)} is no issuer; give https://HOST, as the issuer calls itself"
        )
    if not settings.hosted:
        raise SettingsError(
            f"{where}: a service without teams has nobody to sign in; set {_variable('database_url')}, or leave it out"
        )
    if not settings.oidc_client:
        raise SettingsError(
            f"{_variable('oidc_client')}: give the id by which {settings.oidc_issuer} knows this service"
        )


def is_secure(address: str) -> bool:
    """Tell whether what is asked at an address stays secret: it has TLS, or is on this machine."""
    try:
        url = urlsplit(address)
    except ValueError:
        return False
    return bool(url.hostname) and (url.scheme == "https" or (url.scheme == "http" and url.hostname in LOOPBACK))


def check_secret(settings: Settings) -> None:
    """Check that keys can be digested.

    Raises
    ------
    SettingsError
        The secret is missing or short.
    """
    if len(settings.secret) < _SECRET_CHARACTERS:
        raise SettingsError(
            f"{_variable('secret')}: a service with keys needs a secret of at least {_SECRET_CHARACTERS} characters; "
            "make one by `openssl rand -hex 32`, and keep it: no key is valid with another"
        )


def check_oidc_installed(settings: Settings) -> None:
    """Check that the packages are there by which people sign in at an issuer.

    Raises
    ------
    SettingsError
        They are not.
    """
    if settings.oidc_issuer and find_spec("joserfc") is None:
        raise SettingsError(
            f"{_variable('oidc_issuer')}: this needs a further package; install it: pip install 'treestroke[oidc]'"
        )


def _secret_files() -> list[str]:
    """Return the names of the files that are called as variables are, where there are any."""
    if not os.access(SECRETS, os.R_OK | os.X_OK):
        return []
    return [path.name for path in SECRETS.iterdir() if path.name.upper().startswith(PREFIX)]


def _names(text: str) -> list[str]:
    """Return the names of a list with commas between."""
    return [name.strip().lower() for name in text.split(",") if name.strip()]


def _variable(name: str) -> str:
    return f"{PREFIX}{name.upper()}"


def _allowed(message: str) -> str:
    """Return pydantic's message as the end of a sentence: "Input should be ..." becomes "it should be ..."."""
    return message.replace("Input should", "it should", 1)
