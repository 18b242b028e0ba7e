-- Schema 2: plans of blinded readings, and the events that lost a race.

-- Edits of a film are numbered, so that a stale one is noticed.
ALTER TABLE films ADD COLUMN revision INTEGER NOT NULL DEFAULT 0;

-- The latest time at which a finished reading was worked on: a washout begins here, and not at `finished_ms`, so that a
-- clock that jumped back in mid-reading releases nothing early.
ALTER TABLE readings ADD COLUMN rest_from_ms INTEGER;
UPDATE readings SET rest_from_ms = max(
    finished_ms, begun_ms,
    (SELECT coalesce(max(time_ms), begun_ms) FROM events WHERE reading = readings.id)
) WHERE finished_ms IS NOT NULL;

CREATE TABLE plans (
    id INTEGER PRIMARY KEY,
    study TEXT NOT NULL UNIQUE REFERENCES studies (id),
    repeats INTEGER NOT NULL CHECK (repeats >= 1),
    washout_days INTEGER NOT NULL CHECK (washout_days >= 0),
    seed TEXT NOT NULL
) STRICT;

CREATE TABLE slots (
    code TEXT PRIMARY KEY,
    plan INTEGER NOT NULL REFERENCES plans (id),
    observer TEXT NOT NULL,
    place INTEGER NOT NULL CHECK (place >= 1),
    film INTEGER NOT NULL REFERENCES films (id),
    repeat INTEGER NOT NULL CHECK (repeat >= 1),
    UNIQUE (plan, observer, place),
    UNIQUE (film, observer, repeat)
) STRICT;

CREATE TABLE conflicts (
    id INTEGER PRIMARY KEY,
    object TEXT NOT NULL,
    actor TEXT NOT NULL,
    time_ms INTEGER NOT NULL,
    base_revision INTEGER NOT NULL,
    found_revision INTEGER NOT NULL,
    change TEXT NOT NULL
) STRICT;
CREATE INDEX conflicts_by_object ON conflicts (object, id);

CREATE TRIGGER finished_readings_are_never_edited BEFORE UPDATE ON readings
WHEN OLD.finished_ms IS NOT NULL
BEGIN SELECT RAISE (ABORT, 'a finished reading is immutable'); END;
CREATE TRIGGER finished_readings_get_no_events BEFORE INSERT ON events
WHEN (SELECT finished_ms FROM readings WHERE id = NEW.reading) IS NOT NULL
BEGIN SELECT RAISE (ABORT, 'a finished reading is immutable'); END;
CREATE TRIGGER readings_are_never_deleted BEFORE DELETE ON readings
BEGIN SELECT RAISE (ABORT, 'readings are never deleted'); END;
CREATE TRIGGER conflicts_are_never_edited BEFORE UPDATE ON conflicts
BEGIN SELECT RAISE (ABORT, 'conflicts are append-only'); END;
CREATE TRIGGER conflicts_are_never_deleted BEFORE DELETE ON conflicts
BEGIN SELECT RAISE (ABORT, 'conflicts are append-only'); END;
