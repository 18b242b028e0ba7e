-- Schema 1: studies, films, readings, clicks and the audit log. Times are milliseconds since 1970-01-01 UTC.

-- One row: how long the log is and how it ends.
CREATE TABLE head (
    id INTEGER PRIMARY KEY CHECK (id = 1),
    entries INTEGER NOT NULL,
    hash TEXT NOT NULL,
    last_ms INTEGER NOT NULL
) STRICT;

CREATE TABLE audit (
    sequence INTEGER PRIMARY KEY,
    time_ms INTEGER NOT NULL,
    actor TEXT NOT NULL,
    action TEXT NOT NULL,
    object TEXT NOT NULL,
    digest TEXT NOT NULL,
    hash TEXT NOT NULL
) STRICT;
CREATE INDEX audit_by_object ON audit (object, sequence);

CREATE TABLE contents (
    hash TEXT PRIMARY KEY,
    bytes BLOB NOT NULL
) STRICT;

CREATE TABLE studies (
    id TEXT PRIMARY KEY,
    label TEXT,
    synthetic INTEGER NOT NULL CHECK (synthetic IN (0, 1))
) STRICT;

CREATE TABLE films (
    id INTEGER PRIMARY KEY,
    study TEXT NOT NULL REFERENCES studies (id),
    posture TEXT NOT NULL,
    content TEXT NOT NULL REFERENCES contents (hash),
    image TEXT NOT NULL,
    inverted INTEGER NOT NULL CHECK (inverted IN (0, 1)),
    UNIQUE (study, content)
) STRICT;

CREATE TABLE readings (
    id INTEGER PRIMARY KEY,
    film INTEGER NOT NULL REFERENCES films (id),
    observer TEXT NOT NULL,
    repeat INTEGER NOT NULL CHECK (repeat >= 1),
    begun_ms INTEGER NOT NULL,
    finished_ms INTEGER,
    UNIQUE (film, observer, repeat)
) STRICT;

CREATE TABLE events (
    sequence INTEGER PRIMARY KEY,
    reading INTEGER NOT NULL REFERENCES readings (id),
    revision INTEGER NOT NULL CHECK (revision >= 1),
    time_ms INTEGER NOT NULL,
    event TEXT NOT NULL,
    UNIQUE (reading, revision)
) STRICT;

CREATE TRIGGER audit_is_never_edited BEFORE UPDATE ON audit
BEGIN SELECT RAISE (ABORT, 'the audit log is append-only'); END;
CREATE TRIGGER audit_is_never_deleted BEFORE DELETE ON audit
BEGIN SELECT RAISE (ABORT, 'the audit log is append-only'); END;
CREATE TRIGGER events_are_never_edited BEFORE UPDATE ON events
BEGIN SELECT RAISE (ABORT, 'events are append-only'); END;
CREATE TRIGGER events_are_never_deleted BEFORE DELETE ON events
BEGIN SELECT RAISE (ABORT, 'events are append-only'); END;
