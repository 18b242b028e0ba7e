"""A server with accounts under many, slow or wrong requests, and on a full disk: a reader cannot stop the others."""

from __future__ import annotations

import http.client
import json
import random
import re
import resource
import socket
import subprocess
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from kills import click
from program import MAX_SECONDS, run, temporary

PASSWORD = "four words that do not rhyme"
ROLES = {"lead": "admin", "ed": "editor", "rea": "reader"}
SLOW, REPORTS, WRONG, CLICKS = 48, 48, 50, 93
# A person who waits longer thinks that the program hangs.
PATIENCE_S = 20


class Served:
    """The program over a store with accounts. It ignores SIGXFSZ, as Python does: a file that cannot grow is an error."""

    def __init__(self, program: Path, store: Path) -> None:
        words = [str(program), "serve", str(store), "--port", "0", "--accounts"]
        self.child = subprocess.Popen(
            words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, cwd=store.parent, restore_signals=False
        )
        address = next(filter(None, (re.search(r"http://([\d.]+):(\d+)/", line) for line in self.child.stdout)))
        threading.Thread(target=self.child.stdout.read, daemon=True).start()
        self.host, self.port = address[1], int(address[2])

    def may_grow(self, files: bool) -> None:
        """Lets its files grow, or makes the disk full."""
        _, hard = resource.prlimit(self.child.pid, resource.RLIMIT_FSIZE)
        resource.prlimit(self.child.pid, resource.RLIMIT_FSIZE, (hard if files else 0, hard))

    def end(self) -> None:
        self.child.terminate()
        self.child.wait()


class Browser:
    """A client of the server, with its cookies."""

    def __init__(self, served: Served) -> None:
        self.served = served
        self.cookies: dict[str, str] = {}
        self.csrf = ""

    def headers(self) -> dict[str, str]:
        served = self.served
        cookies = "; ".join(f"{name}={value}" for name, value in self.cookies.items())
        kind = {"Origin": f"http://{served.host}:{served.port}", "Content-Type": "application/json"}
        return kind | {"X-Spineline-Csrf": self.csrf} | ({"Cookie": cookies} if cookies else {})

    def ask(self, method: str, path: str, body: Any = None) -> tuple[int, bytes]:
        """Status and body of the answer; status 0 if it takes too long."""
        connection = http.client.HTTPConnection(self.served.host, self.served.port, timeout=PATIENCE_S)
        try:
            connection.request(method, path, None if body is None else json.dumps(body), self.headers())
            response = connection.getresponse()
            data = response.read()
        except OSError:
            return 0, b"no answer"
        finally:
            connection.close()
        for cookie in response.msg.get_all("set-cookie", []):
            name, _, value = cookie.split(";")[0].partition("=")
            self.cookies[name] = value
        return response.status, data

    def sign_in(self, name: str, password: str = PASSWORD) -> int:
        status, data = self.ask("POST", "/api/session", {"kind": "account", "name": name, "password": password})
        if status == 200:
            self.csrf = json.loads(data)["csrf"]
        return status


def attack(program: Path, samples: Path, seed: int) -> Iterator[str]:
    """Faults over all crowds."""
    rng = random.Random(f"{seed} crowds")
    with temporary() as place:
        store = Path(place) / "study.spineline"
        created = run(program, ["study", "create", store.name], store.parent)
        added = run(program, ["study", "add", store.name, str(samples / "films" / "phantom-rod-01.json")], store.parent)
        if created.code or added.code:
            yield f"no store: {created.errors}{added.errors}"
            return
        for name, role in ROLES.items():
            words = [program, "account", "add", name, "--role", role, "--password-stdin", store.name]
            subprocess.run(words, input=PASSWORD, text=True, cwd=store.parent, check=True, stdout=subprocess.DEVNULL)
        served = Served(program, store)
        try:
            yield from crowds(served, rng)
        finally:
            served.end()
        checked = run(program, ["study", "verify", store.name], store.parent)
        if checked.code:
            yield f"crowds: verify ended with {checked.code}: {checked.errors}"
        log = run(program, ["study", "log", store.name], store.parent).output
        for action in ("sign_in ", "sign_in_refused", "sign_in_late", "export_report_late"):
            if action not in log:
                yield f"crowds: no {action} in the log"
    print(f"   4 crowds: {SLOW} slow bodies, {REPORTS} reports, {WRONG} wrong passwords, a full disk")


def crowds(served: Served, rng: random.Random) -> Iterator[str]:
    """Faults of one server."""
    lead, editor, reader = (Browser(served) for _ in ROLES)
    for name, browser in zip(ROLES, (lead, editor, reader), strict=True):
        if browser.sign_in(name) != 200:
            yield f"{name} cannot sign in"
            return
    study = json.loads(lead.ask("GET", "/api/studies")[1])[0]["id"]
    grants = [{"name": "ed", "role": "editor"}, {"name": "rea", "role": "reader"}]
    lead.ask("PUT", f"/api/studies/{study}/grants", grants)
    film = json.loads(editor.ask("GET", f"/api/studies/{study}")[1])["summary"]["films"][0]["film"]
    reading = json.loads(editor.ask("POST", f"/api/films/{film}/readings", {"repeat": 1})[1])
    marker = Marker(editor, reading["reading"], reading["revision"], rng)

    slow = [slow_body(reader, f"/api/readings/{reading['reading']}/events") for _ in range(SLOW)]
    for path in ("/api/session", "/api/studies", f"/api/studies/{study}"):
        if (status := editor.ask("GET", path)[0]) != 200:
            yield f"{SLOW} slow bodies: GET {path} gives {status}"
    if refused := marker.refused(10):
        yield f"{SLOW} slow bodies: {refused} of 10 clicks refused"
    for connection in slow:
        connection.close()

    report = f"/api/studies/{study}/exports/report"
    readers = [threading.Thread(target=reader.ask, args=("GET", report)) for _ in range(REPORTS)]
    for thread in readers:
        thread.start()
    if refused := marker.refused(CLICKS):
        yield f"{REPORTS} reports: {refused} of {CLICKS} clicks refused"
    if (status := lead.ask("GET", "/api/studies")[0]) != 200:
        yield f"{REPORTS} reports: another account gets {status}"
    for thread in readers:
        thread.join()

    for number in range(WRONG):
        who = rng.choice(["lead", "root", "admin", f"guess-{number}"])
        Browser(served).sign_in(who, f"{number} is not the password")
    for name in ("ed", "rea"):
        if (status := Browser(served).sign_in(name)) != 200:
            yield f"{WRONG} wrong passwords: {name}, who was not guessed, gets {status}"
    lead.ask("DELETE", "/api/session")
    if (status := lead.sign_in("lead")) != 200:
        yield f"{WRONG} wrong passwords: a browser that signed in lately gets {status}"

    served.may_grow(False)
    newcomer = Browser(served)
    if (status := newcomer.sign_in("rea")) != 200:
        yield f"full disk: signing in gives {status}"
    for path in ("/api/session", "/api/studies", f"/api/studies/{study}", report, f"/api/studies/{study}/case"):
        if (status := newcomer.ask("GET", path)[0]) != 200:
            yield f"full disk: GET {path} gives {status}"
    if (status := marker.click()) != 507:
        yield f"full disk: a click gives {status}"
    if (status := newcomer.ask("DELETE", "/api/session")[0]) != 204:
        yield f"full disk: signing out gives {status}"
    served.may_grow(True)
    if (status := marker.click()) != 200:
        yield f"room again: a click gives {status}"


class Marker:
    """An editor who places landmarks one after the other."""

    def __init__(self, browser: Browser, reading: int, revision: int, rng: random.Random) -> None:
        self.browser, self.reading, self.revision, self.rng = browser, reading, revision, rng
        self.places: dict[tuple[str, str], list[float]] = {}

    def click(self) -> int:
        """Status of the answer to a click."""
        event = click(self.rng, self.places)
        body = {"expected_revision": self.revision, "events": [event]}
        status, data = self.browser.ask("POST", f"/api/readings/{self.reading}/events", body)
        if status == 200:
            self.revision = json.loads(data)["reading"]["revision"]
            self.places[event["level"], event["corner"]] = []
        return status

    def refused(self, count: int) -> int:
        """How many of `count` clicks were not recorded."""
        return sum(self.click() != 200 for _ in range(count))


def slow_body(browser: Browser, path: str) -> socket.socket:
    """A connection with a JSON body that never ends."""
    served = browser.served
    connection = socket.create_connection((served.host, served.port), timeout=MAX_SECONDS)
    lines = [f"POST {path} HTTP/1.1", f"Host: {served.host}:{served.port}", "Content-Length: 400"]
    lines += [f"{name}: {value}" for name, value in browser.headers().items()]
    connection.sendall("\r\n".join([*lines, "", '{"expected_revision": 0']).encode())
    return connection
