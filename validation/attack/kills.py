"""A server that is killed while films are marked and uploaded: all acknowledged changes are kept."""

from __future__ import annotations

import http.client
import json
import os
import random
import re
import signal
import subprocess
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from program import MAX_SECONDS, parts, run, temporary
from small import png

LEVELS = "L4 L3 L2 L1 T12 T11 T10 T9 T8 T7 T6 T5 T4 T3 T2".split()
CORNERS = ("superior_left", "superior_right", "inferior_right", "inferior_left")


class Server:
    """The program over a store, with one session."""

    def __init__(self, program: Path, store: Path, *, port: int = 0, environment: dict[str, str] | None = None) -> None:
        words = [str(program), "serve", str(store), "--port", str(port)]
        around = os.environ | (environment or {})
        self.child = subprocess.Popen(
            words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=store.parent, env=around
        )
        self.errors: list[str] = []
        threading.Thread(target=lambda: self.errors.extend(self.child.stderr), daemon=True).start()
        address = None
        for line in self.child.stdout:
            address = re.search(r"http://([\d.]+):(\d+)/?#token=(\S+)", line)
            if address:
                break
        if not address:
            raise RuntimeError(f"no address: {''.join(self.errors)}")
        threading.Thread(target=self.child.stdout.read, daemon=True).start()
        self.host, self.port = address[1], int(address[2])
        self.headers = {"Origin": f"http://{self.host}:{self.port}", "Content-Type": "application/json"}
        body, headers = self.answer("POST", "/api/session", {"kind": "token", "token": address[3], "observer": "attacker"})
        self.headers["Cookie"] = headers["set-cookie"].split(";")[0]
        self.headers["X-Spineline-Csrf"] = body["csrf"]

    def answer(self, method: str, path: str, body: Any = None) -> tuple[Any, dict[str, str]]:
        """The answer to a request; an error if it fails."""
        connection = http.client.HTTPConnection(self.host, self.port, timeout=MAX_SECONDS)
        data = body if isinstance(body, bytes) or body is None else json.dumps(body)
        kind = {"Content-Type": "application/octet-stream"} if isinstance(body, bytes) else {}
        connection.request(method, path, data, self.headers | kind)
        response = connection.getresponse()
        text = response.read()
        if response.status >= 400:
            raise RuntimeError(f"{method} {path}: {response.status} {text[:300]!r}")
        headers = {name.lower(): value for name, value in response.getheaders()}
        return (json.loads(text) if text else None), headers

    def kill(self) -> None:
        """Kills it, like a power cut."""
        os.kill(self.child.pid, signal.SIGKILL)
        self.child.wait()


def attack(program: Path, samples: Path, kills: int, seed: int) -> Iterator[str]:
    """Faults over `kills` kills of one store."""
    rng = random.Random(f"{seed} kills")
    film = png(64, 64)
    clicks = uploads = 0
    with temporary() as place:
        store = Path(place) / "study.spineline"
        created = run(program, ["study", "create", store.name], store.parent)
        added = run(program, ["study", "add", store.name, str(samples / "films" / "phantom-rod-01.json")], store.parent)
        if created.code or added.code:
            yield f"no store: {created.errors}{added.errors}"
            return
        server = Server(program, store)
        reading, places, revision = begun(server)
        for number in range(kills):
            timer = threading.Timer(rng.uniform(0.02, 0.6), server.kill)
            timer.start()
            acknowledged = dict(places)
            while True:
                try:
                    if rng.random() < 0.1:
                        server.answer("POST", "/api/uploads", film)
                        uploads += 1
                    event = click(rng, places)
                    body = {"expected_revision": revision, "events": [event]}
                    preview, _ = server.answer("POST", f"/api/readings/{reading}/events", body)
                except (OSError, http.client.HTTPException):
                    break
                except RuntimeError as error:
                    yield f"kill {number}: {error}"
                    break
                revision = preview["reading"]["revision"]
                places[event["level"], event["corner"]] = [event["column_px"], event["row_px"]]
                acknowledged = dict(places)
                clicks += 1
            timer.join()
            server.child.wait()
            checked = run(program, ["study", "verify", store.name], store.parent)
            if checked.code:
                yield f"kill {number}: verify ended with {checked.code}: {checked.errors}"
            server = Server(program, store)
            view, _ = server.answer("GET", f"/api/readings/{reading}")
            places, revision = corners(view), view["revision"]
            # The unanswered click may be kept or not.
            lost = [key for key, px in acknowledged.items() if places.get(key) != px and not under_way(event, key, places)]
            if lost:
                yield f"kill {number}: lost {lost}"
        server.kill()
        if left := parts(store.parent):
            yield f"kills left {left}"
    print(f"{kills:4} kills, {clicks} clicks and {uploads} uploads acknowledged, all kept unless listed below")


def under_way(event: dict[str, Any], key: tuple[str, str], places: dict[tuple[str, str], list[float]]) -> bool:
    """Whether a place is from the unanswered click."""
    return (event["level"], event["corner"]) == key and places.get(key) == [event["column_px"], event["row_px"]]


def begun(server: Server) -> tuple[int, dict[tuple[str, str], list[float]], int]:
    """A new reading of the first film."""
    studies, _ = server.answer("GET", "/api/studies")
    study, _ = server.answer("GET", f"/api/studies/{studies[0]['id']}")
    film = study["summary"]["films"][0]["film"]
    view, _ = server.answer("POST", f"/api/films/{film}/readings", {"repeat": 1})
    return view["reading"], corners(view), view["revision"]


def corners(view: dict[str, Any]) -> dict[tuple[str, str], list[float]]:
    """Places of the corners of a reading."""
    return {(v["level"], c["corner"]): c["px"] for v in view["vertebrae"] for c in v["corners"]}


def click(rng: random.Random, places: dict[tuple[str, str], list[float]]) -> dict[str, Any]:
    """A random corner, placed or moved."""
    level, corner = rng.choice(LEVELS), rng.choice(CORNERS)
    kind = "move_corner" if (level, corner) in places else "place_corner"
    place = {"column_px": float(rng.randint(100, 900)), "row_px": float(rng.randint(100, 1900))}
    return {"kind": kind, "level": level, "corner": corner} | place
