"""Models that are looked for by words, tags and people."""

from collections.abc import Sequence
from dataclasses import dataclass

from sqlalchemy import select
from sqlalchemy.orm import Session

from treestroke.store.queries import maker_names
from treestroke.store.tables import ModelRow

LOOKED_THROUGH = 1000
"""Most rows that one page of a search looks through."""


@dataclass(frozen=True)
class Search:
    """What models are looked for: ``words`` in name, tags or the maker's name, one tag, and who made them."""

    words: str = ""
    tag: str = ""
    maker: str = ""

    def finds(self, name: str, tags: Sequence[str], maker: str, maker_name: str) -> bool:
        """Tell whether a model is one of those; small and capital letters are equal."""
        texts, tag = (name, *tags, maker_name), self.tag.casefold()
        return (
            self.maker in ("", maker)
            and (not tag or any(one.casefold() == tag for one in tags))
            and all(any(word in text.casefold() for text in texts) for word in self.words.casefold().split())
        )


def search(
    session: Session, wanted: Search, cursor: str | None, limit: int, look_through: int = LOOKED_THROUGH
) -> tuple[Sequence[ModelRow], str | None]:
    """Return a page of the models that are looked for, newest first, and the cursor of the next page.

    A page looks through so many models at most, by an index, however many there are: it may be short or even empty
    where more follow. Words are compared here, since databases disagree about capital letters beyond ASCII.
    """
    columns = select(ModelRow.number, ModelRow.name, ModelRow.tags, ModelRow.maker).where(ModelRow.deleted.is_(None))
    query = columns.order_by(ModelRow.number.desc()).limit(look_through)
    seen = session.execute(query if cursor is None else query.where(ModelRow.number < int(cursor))).all()
    names = maker_names(session, {row.maker for row in seen})
    found = [row.number for row in seen if wanted.finds(row.name, row.tags, row.maker, names.get(row.maker, ""))]
    rows = session.scalars(select(ModelRow).where(ModelRow.number.in_(found[:limit])).order_by(ModelRow.number.desc()))
    if len(found) > limit:
        return rows.all(), str(found[limit - 1])
    return rows.all(), str(seen[-1].number) if len(seen) == look_through else None
