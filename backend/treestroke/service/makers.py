"""Who made what: ids and names of people, as answers show them."""

from collections.abc import Iterable
from dataclasses import dataclass

from sqlalchemy.orm import Session

from treestroke.store.database import Database
from treestroke.store.queries import maker_names
from treestroke.store.scope import LOCAL, Authored


@dataclass(frozen=True)
class Maker:
    """Somebody who made something; without a name where they are no longer a member."""

    id: str
    name: str


Makers = dict[str, Maker]
"""People by their ids."""


def makers_of(session: Session, rows: Iterable[Authored]) -> Makers:
    """Return who made rows; nobody where nobody signs in, since all is then one person's."""
    ids = {row.maker for row in rows} - {LOCAL.maker}
    names = maker_names(session, ids) if ids else {}
    return {id: Maker(id, names.get(id, "")) for id in ids}


def find_makers(database: Database, rows: Iterable[Authored]) -> Makers:
    """Return who made rows, as `makers_of`."""
    with database.reading() as session:
        return makers_of(session, rows)
