import time
from pathlib import Path

import pytest
from sqlalchemy import delete, exists, func, select, union, update
from sqlalchemy.orm import aliased
from tests.rows import add_capture, add_model, add_solve

from treestroke.store import leases, queries
from treestroke.store.database import Database
from treestroke.store.scope import SERVICE, Authored, Foreign, Owned, Scope, Unscoped
from treestroke.store.tables import (
    File,
    ModelPart,
    ModelRow,
    PhotoRow,
    Replay,
    StoreClock,
    Table,
    Turn,
    Worker,
)

OAKS, ELMS = Scope("oaks", "usr_ann"), Scope("elms", "usr_ben")
SHARED = {Worker, Turn, StoreClock}
"""Tables of the service itself, whose rows tell nothing about a team's trees."""


def test_a_database_without_a_scope_has_no_sessions(tmp_path: Path) -> None:
    database = Database(tmp_path)
    database.migrate()
    for session in (database.reading, database.writing, database.autocommitting):
        with pytest.raises(Unscoped), session():
            pass


def test_every_table_belongs_to_teams_or_to_the_service() -> None:
    tables = {mapper.class_ for mapper in Table.registry.mappers}
    assert {table for table in tables if not issubclass(table, Owned)} == SHARED


def test_rows_are_of_the_team_and_person_who_write_them(database: Database) -> None:
    own = add_model(database.of(OAKS))
    with database.of(SERVICE).reading() as session:
        row, part = session.get_one(ModelRow, own.number), session.scalars(select(ModelPart)).first()
        assert (row.team, row.maker) == ("oaks", "usr_ann")
        assert part is not None
        assert part.team == "oaks"
    assert issubclass(ModelRow, Authored)


@pytest.mark.parametrize(("scope", "team"), [(OAKS, "elms"), (SERVICE, None)])
def test_a_row_of_another_team_or_of_none_is_refused(database: Database, scope: Scope, team: str | None) -> None:
    with pytest.raises(Foreign), database.of(scope).writing() as session:
        session.add(_photo(team=team) if team else _photo())


def test_no_form_of_select_sees_another_team(database: Database) -> None:
    mine, theirs = add_model(database.of(OAKS)), add_model(database.of(ELMS))
    other = aliased(ModelRow)
    forms = (
        select(ModelRow),
        select(ModelRow.id),
        select(ModelRow.id, ModelRow.seq).where(ModelRow.id.in_([mine.id, theirs.id])),
        select(other.id),
        select(func.max(ModelRow.id)),
        select(select(ModelRow.id).subquery().c.id),
        union(select(ModelRow.id), select(ModelPart.model)),
        select(ModelRow.id).where(exists().where(ModelPart.model == theirs.id)),
        select(ModelRow.id).join(ModelPart, ModelPart.model == ModelRow.id),
        select(func.count()).where(ModelRow.status == "queued"),
    )
    with database.of(OAKS).reading() as session:
        found = [session.execute(form).all() for form in forms]
        assert session.get(ModelRow, theirs.number) is None
        assert session.get(ModelRow, mine.number) is not None
        assert session.query(ModelRow).count() == 1
        assert session.get(ModelPart, (theirs.id, "photo")) is None
    assert [len(rows) for rows in found] == [1, 1, 1, 1, 1, 1, 1, 0, 2, 1]
    assert found[-1][0][0] == 1
    assert theirs.id not in str(found)


def test_no_update_and_no_delete_reaches_another_team(database: Database) -> None:
    theirs = add_model(database.of(ELMS))
    with database.of(OAKS).writing() as session:
        session.execute(update(ModelRow).values(name="mine"))
        session.execute(delete(ModelPart))
        assert session.scalars(update(ModelRow).values(seq=9).returning(ModelRow.id)).all() == []
        leases.cancel(session, ModelRow, ModelRow.id == theirs.id)
        assert not queries.mark_deleted(session, ModelRow, theirs.id)
        assert leases.claim_next(session, leases.Holder("t", "w", "treestroke")) is None
    with database.of(ELMS).reading() as session:
        row = session.get_one(ModelRow, theirs.number)
        assert (row.name, row.status, row.seq, row.deleted) == ("", "queued", 1, None)
        assert len(queries.parts(session, [theirs.id])[theirs.id]) == 2


def test_the_service_sees_all(database: Database) -> None:
    add_model(database.of(OAKS))
    add_model(database.of(ELMS))
    with database.of(SERVICE).reading() as session:
        assert set(session.scalars(select(ModelRow.team))) == {"oaks", "elms"}


def test_places_in_the_queue_are_the_teams_own(database: Database) -> None:
    for _ in range(3):
        add_model(database.of(OAKS))
    theirs = add_model(database.of(ELMS))
    for scope in (ELMS, SERVICE):
        with database.of(scope).reading() as session:
            assert queries.queue_positions(session, ModelRow, [theirs.number]) == {theirs.number: 1}


def test_a_finished_model_answers_its_own_team_alone(database: Database) -> None:
    add_model(database.of(ELMS), status="succeeded")
    with database.of(OAKS).reading() as session:
        assert queries.finished(session, ModelRow, "f" * 64, "treestroke") is None
    with database.of(ELMS).reading() as session:
        assert queries.finished(session, ModelRow, "f" * 64, "treestroke") is not None


def test_a_solve_and_a_photo_of_a_capture_are_the_teams(database: Database) -> None:
    capture = add_capture(database.of(ELMS), ["a" * 64])
    add_solve(database.of(ELMS), capture.id)
    with database.of(OAKS).reading() as session:
        assert queries.capture(session, capture.id) is None
        assert queries.capture_photos(session, [capture.id]) == {capture.id: []}
        assert queries.last_solve(session, capture.id, "f" * 64) is None
        assert queries.stored_bytes(session) == 0
        assert not queries.referenced(session)
    with database.of(ELMS).reading() as session:
        assert queries.referenced(session) == {"a" * 64}


def test_a_key_is_one_persons(database: Database) -> None:
    for scope in (OAKS, ELMS, Scope("oaks", "usr_cleo")):
        with database.of(scope).writing() as session:
            assert queries.replay(session, "k") is None
            session.add(Replay(key="k", fingerprint=scope.maker, model="m", created=0.0))
    with database.of(OAKS).reading() as session:
        found = queries.replay(session, "k")
        assert found is not None
        assert found.fingerprint == "usr_ann"


def test_files_of_a_workers_result_are_the_teams(database: Database) -> None:
    row = add_model(database.of(OAKS))
    with database.of(SERVICE).writing() as session:
        job = leases.claim_next(session, leases.Holder("t", "w", "treestroke"))
        assert isinstance(job, ModelRow)
        assert leases.succeed(session, job, {}, {"tree.glb": ("c" * 64, 5)})
    with database.of(OAKS).reading() as session:
        assert set(queries.files(session, [row.id])[row.id]) == {"tree.glb"}
    with database.of(ELMS).reading() as session:
        assert session.scalars(select(File)).all() == []


def _photo(**values: str) -> PhotoRow:
    blob = "a" * 64
    return PhotoRow(
        id=queries.new_id("pho"), sha256=blob, blob=blob, width=64, height=64, created=time.time(), **values
    )
