import pytest
from sqlalchemy import select
from tests.rows import add_model

from treestroke.store.audit import COMMAND_LINE, ORIGIN, Origin, operator_of, record
from treestroke.store.database import Database
from treestroke.store.queries import mark_deleted, mark_restored
from treestroke.store.scope import SERVICE, Foreign, Scope
from treestroke.store.tables import AuditRow, ModelRow

OAKS = Scope("oaks", "usr_ann", credential="key_1")


def entries(database: Database) -> list[AuditRow]:
    with database.of(SERVICE).reading() as session:
        return list(session.scalars(select(AuditRow).order_by(AuditRow.number)))


def test_an_act_is_recorded_with_who_did_it_and_from_where(database: Database) -> None:
    token = ORIGIN.set(Origin("10.0.0.1", "request-1"))
    with database.of(OAKS).writing() as session:
        record(session, "key.made", "key_2", name="laptop")
    ORIGIN.reset(token)
    (row,) = entries(database)
    assert (row.team, row.who, row.credential) == ("oaks", "usr_ann", "key_1")
    assert (row.action, row.subject, row.details) == ("key.made", "key_2", {"name": "laptop"})
    assert (row.address, row.request_id) == ("10.0.0.1", "request-1")


def test_what_is_rolled_back_was_not_done(database: Database) -> None:
    def fail() -> None:
        with database.of(OAKS).writing() as session:
            record(session, "key.made", "key_2")
            session.flush()
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail()
    assert entries(database) == []


def test_whoever_runs_the_service_is_no_member(database: Database) -> None:
    with database.of(SERVICE).writing() as session:
        record(session, "key.revoked", "key_2", operator_of("oaks"))
    (row,) = entries(database)
    assert (row.team, row.who, row.credential) == ("oaks", None, COMMAND_LINE)


def test_an_act_of_no_team_is_a_mistake(database: Database) -> None:
    with pytest.raises(Foreign), database.of(SERVICE).writing() as session:
        record(session, "key.revoked", "key_2")


def test_one_person_without_keys_records_nothing(database: Database) -> None:
    with database.writing() as session:
        record(session, "model.deleted", "mdl_1")
    assert entries(database) == []


def test_deleting_and_restoring_are_recorded_once(database: Database) -> None:
    model = add_model(database.of(OAKS))
    with database.of(OAKS).writing() as session:
        for mark in (mark_deleted, mark_deleted, mark_restored, mark_restored):
            mark(session, ModelRow, model.id)
    assert [(row.action, row.subject) for row in entries(database)] == [
        ("model.deleted", model.id),
        ("model.restored", model.id),
    ]
