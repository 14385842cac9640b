"""Teams that ask for models all the time, by whichever web process answers, as clients behind a balancer do."""

import random
import threading
import time
from dataclasses import dataclass, field

import httpx
from tests.chaos.stack import Stack, Team
from tests.faults.harness import QUICK, small_tree

PATIENCE_SECONDS = 300.0
"""How long a client asks again for one thing."""
CANCELED = 0.04
"""Part of the models that their team cancels at once."""
AGAIN = (408, 429, 503, 507)
"""Answers that say: ask again."""


@dataclass
class Asked:
    """What a team asked for, and what it was told."""

    team: Team
    ids: list[str] = field(default_factory=list)
    canceled: set[str] = field(default_factory=set)
    accepted_s: list[float] = field(default_factory=list)
    """How long each model took to be accepted, earlier tries included."""
    answered_s: list[float] = field(default_factory=list)
    """How long the answers took that accepted them."""
    violations: list[str] = field(default_factory=list)


class Asker:
    """One team's client, in a thread of its own."""

    def __init__(self, stack: Stack, team: Team, number: int, seconds: float, seed: int) -> None:
        self.asked = Asked(team)
        self._stack, self._number, self._seconds = stack, number, seconds
        self._chance = random.Random(f"{team.name} {seed}")
        self.thread = threading.Thread(target=self._run, name=f"asker-{team.name}")

    def _run(self) -> None:
        try:
            photo, began = self._upload(), time.monotonic()
            for number in range(self._number):
                time.sleep(max(began + self._seconds * number / self._number - time.monotonic(), 0.0))
                self._ask_for_model(photo, number)
        except Exception as error:  # noqa: BLE001 - whatever ends a client is a finding
            self.asked.violations.append(f"a client of {self.asked.team.name} ended: {error!r}")

    def _upload(self) -> str:
        headers = {"Content-Type": "image/png"}
        return str(self._sent("POST", "/v1/photos", content=small_tree()[0], headers=headers).json()["id"])

    def _ask_for_model(self, photo: str, number: int) -> None:
        key = f"{self.asked.team.name}-{number}"
        body = {"photo": photo, "strokes": small_tree()[1], "settings": QUICK, "seed": number, "name": key}
        began = time.monotonic()
        answer = self._sent("POST", "/v1/models", json=body, headers={"Idempotency-Key": key})
        assert answer.status_code == httpx.codes.ACCEPTED, answer.text
        self.asked.answered_s.append(answer.elapsed.total_seconds())
        id = str(answer.json()["id"])
        self.asked.accepted_s.append(time.monotonic() - began)
        if id in self.asked.ids:
            self.asked.violations.append(f"{key}: {id} was accepted for another key, too")
        self.asked.ids.append(id)
        if self._chance.random() < CANCELED:
            self.asked.canceled.add(id)  # it may be finished before
            self._sent("POST", f"/v1/models/{id}/cancel")

    def _sent(self, method: str, path: str, **request: object) -> httpx.Response:
        """Send a request to one web process or another until it is answered for good."""
        deadline = time.monotonic() + PATIENCE_SECONDS
        while (answer := self._try(method, path, request)) is None or answer.status_code in AGAIN:
            if time.monotonic() > deadline:
                raise AssertionError(f"{method} {path}: {'no answer' if answer is None else answer.text}")
            time.sleep(self._chance.uniform(0.2, 1.0))
        return answer

    def _try(self, method: str, path: str, request: dict[str, object]) -> httpx.Response | None:
        web = self._chance.randrange(len(self._stack.webs))
        with self._stack.client(web, self.asked.team) as client:
            try:
                return client.request(method, path, **request)  # type: ignore[arg-type]
            except httpx.TransportError:
                return None
