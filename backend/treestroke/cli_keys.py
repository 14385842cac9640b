"""`treestroke keys` and `treestroke migrate`: how a team begins, what its operator revokes, and the tables."""

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from typing import TYPE_CHECKING

from treestroke.core.errors import SettingsError
from treestroke.store.data_folder import DataFolderError

if TYPE_CHECKING:
    from treestroke.service.team_setup import ListedKey
    from treestroke.settings import Settings
    from treestroke.store.database import Database
    from treestroke.wire_accounts import KeyRequest

_ACTIONS = ("add", "list", "revoke")


def add_key_flags(command: argparse.ArgumentParser) -> None:
    """Add what `treestroke keys` takes."""
    command.add_argument("action", metavar="ACTION", choices=_ACTIONS, help=", ".join(_ACTIONS))
    command.add_argument("key", metavar="ID", nargs="?", help="with revoke: the key's id, key_...")
    command.add_argument("--team", metavar="NAME", help="team by name or id; with add, it is made where it is new")
    command.add_argument("--member", metavar="NAME", help="whose key; made where new (default owner)")
    command.add_argument("--role", metavar="ROLE", help="of a new member: owner, member or viewer")
    command.add_argument("--scopes", metavar="A,B", help="what the key is for: trees, team (default both)")
    command.add_argument("--read-only", action="store_true", help="the key changes nothing")
    command.add_argument("--days", metavar="N", help="the key expires after so many days (default 90)")


def keys(settings: "Settings", options: argparse.Namespace) -> None:
    """Make a key and print it, list keys, or revoke one.

    Raises
    ------
    TreestrokeError
        The service has no keys, or what was given cannot be used.
    DataFolderError
        The database does not answer, or was made by a newer program.
    """
    if not settings.hosted:
        raise SettingsError(
            "keys: a service without a database of its own has one person and no keys; set TREESTROKE_DATABASE_URL"
        )
    with opened(settings) as database:
        database.check()
        database.migrate()
        _ACTS[options.action](settings, database, options)


def migrate(settings: "Settings") -> None:
    """Bring the tables up to date, and grant the service's user what it may.

    Raises
    ------
    DataFolderError
        The database does not answer, was made by a newer program, or has tables that belong to another user.
    """
    from treestroke.store.data_folder import prepare_folder

    prepare_folder(settings.folder)
    with opened(settings) as database:
        database.check()
        database.migrate(again=True)
    print(f"treestroke: the tables of {database.place} are up to date")


@contextmanager
def opened(settings: "Settings") -> Iterator["Database"]:
    """Open the database for a command; what its server says is one line.

    Raises
    ------
    DataFolderError
        The database does not answer, or refuses what is done.
    """
    from sqlalchemy.exc import DBAPIError, OperationalError

    from treestroke.store.database import Database

    database = Database(settings.folder, settings.database_url, settings.owner_database_url)
    try:
        yield database
    except OperationalError as error:
        raise DataFolderError(
            f"TREESTROKE_DATABASE_URL: the database does not answer ({error.orig}); start it, or correct the address"
        ) from error
    except DBAPIError as error:
        why = str(error.orig).partition("\n")[0]
        raise DataFolderError(
            f"{database.place}: the database refuses ({why}); name the owner of all tables by "
            "TREESTROKE_OWNER_DATABASE_URL"
        ) from error
    finally:
        database.close()


def _add(settings: "Settings", database: "Database", options: argparse.Namespace) -> None:
    from treestroke.service.team_setup import Person, add_key
    from treestroke.settings import check_secret

    check_secret(settings)
    if not options.team:
        raise SettingsError("--team: it is missing; name the team, which is made where it is new")
    if options.role not in (None, "owner", "member", "viewer"):
        raise SettingsError(f"--role {options.role}: there is no such role; take owner, member or viewer")
    wanted = _wanted(options)
    made = add_key(database, settings.secret, Person(options.team, options.member or "owner", options.role), wanted)
    print(made.key)


def _wanted(options: argparse.Namespace) -> "KeyRequest":
    """Return the key that the flags ask for, checked as one that a request asks for."""
    from treestroke.codec.refusals import checked
    from treestroke.wire_accounts import KeyRequest

    days = {} if options.days is None else {"days": int(options.days) if options.days.isdecimal() else options.days}
    scopes = (options.scopes or "trees,team").split(",")
    wanted = {"name": "command line", "scopes": scopes, "read_only": options.read_only, **days}
    return checked(KeyRequest, wanted, SettingsError)


def _list(_: "Settings", database: "Database", options: argparse.Namespace) -> None:
    from treestroke.service.team_setup import list_all_keys

    for found in list_all_keys(database, options.team or ""):
        print(_line(found))


def _revoke(_: "Settings", database: "Database", options: argparse.Namespace) -> None:
    from treestroke.service.team_setup import revoke_any_key

    if options.key is None:
        raise SettingsError("keys revoke: the key's id is missing; `treestroke keys list` names all")
    revoke_any_key(database, options.key)


def _line(found: "ListedKey") -> str:
    """Return a key as one line: id, beginning, team, member and role, what it is for, and until when."""
    key, member, team = found
    ends = "revoked" if key.revoked is not None else f"expires {datetime.fromtimestamp(key.expires, UTC):%Y-%m-%d}"
    scopes = key.scopes.replace(" ", ",") + (" read-only" if key.read_only else "")
    return f"{key.id}  {key.beginning}...  {team.name}  {member.name} ({member.role})  {scopes}  {ends}"


_ACTS = {"add": _add, "list": _list, "revoke": _revoke}
