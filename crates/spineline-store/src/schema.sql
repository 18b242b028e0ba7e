-- The schema, version 1. Times are milliseconds since 1970-01-01 UTC.

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

-- Studies and their films.

CREATE TABLE contents (
    hash TEXT PRIMARY KEY,
    bytes BLOB NOT NULL
) STRICT;

-- Edits of a study and of a film are numbered, so that a stale one is noticed. An archived study is read-only.
CREATE TABLE studies (
    id TEXT PRIMARY KEY,
    label TEXT,
    synthetic INTEGER NOT NULL CHECK (synthetic IN (0, 1)),
    archived INTEGER NOT NULL CHECK (archived IN (0, 1)),
    revision INTEGER NOT NULL
) STRICT;

CREATE TABLE films (
    id INTEGER PRIMARY KEY,
    study TEXT NOT NULL REFERENCES studies (id),
    posture TEXT NOT NULL,
    content TEXT NOT NULL REFERENCES contents (hash),
    image TEXT NOT NULL,
    inverted INTEGER NOT NULL CHECK (inverted IN (0, 1)),
    revision INTEGER NOT NULL,
    UNIQUE (study, content)
) STRICT;
-- A study has one lateral film.
CREATE UNIQUE INDEX one_lateral_film ON films (study) WHERE posture = 'lateral';

-- Small pictures of films, so that a list of studies need not decode every film again. They are derived from the
-- contents and drawn again when they are missing, so the log does not cover these rows.
CREATE TABLE thumbnails (
    content TEXT PRIMARY KEY REFERENCES contents (hash),
    plain BLOB NOT NULL,
    inverted BLOB NOT NULL
) STRICT;

-- Readings and their events.

-- `rest_from_ms` is the latest time at which a finished reading was worked on: a washout begins here, and not at
-- `finished_ms`, so that a clock that jumped back in mid-reading releases nothing early. A correction is a reading that
-- begins with the events of the reading `corrects`, and has its observer and repeat.
CREATE TABLE readings (
    id INTEGER PRIMARY KEY,
    film INTEGER NOT NULL REFERENCES films (id),
    observer TEXT NOT NULL,
    repeat INTEGER NOT NULL CHECK (repeat >= 1),
    begun_ms INTEGER NOT NULL,
    finished_ms INTEGER,
    rest_from_ms INTEGER,
    corrects INTEGER REFERENCES readings (id)
) STRICT;
CREATE UNIQUE INDEX one_reading_of_a_repeat ON readings (film, observer, repeat) WHERE corrects IS NULL;

-- Readings that no longer count, for the reason of a person or because a correction replaces them.
CREATE TABLE withdrawals (
    reading INTEGER PRIMARY KEY REFERENCES readings (id),
    who TEXT NOT NULL,
    time_ms INTEGER NOT NULL,
    reason TEXT,
    corrected_by INTEGER REFERENCES readings (id),
    CHECK ((reason IS NULL) <> (corrected_by IS NULL))
) STRICT;

CREATE TABLE events (
    sequence INTEGER PRIMARY KEY,
    reading INTEGER NOT NULL REFERENCES readings (id),
    revision INTEGER NOT NULL CHECK (revision >= 1),
    time_ms INTEGER NOT NULL,
    event TEXT NOT NULL,
    UNIQUE (reading, revision)
) STRICT;

-- Changes based on an old revision.
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

-- Plans of blinded readings. A plan that is changed before its first reading stays, and another one replaces it.

CREATE TABLE plans (
    id INTEGER PRIMARY KEY,
    study TEXT NOT NULL REFERENCES studies (id),
    repeats INTEGER NOT NULL CHECK (repeats >= 1),
    washout_days INTEGER NOT NULL CHECK (washout_days >= 0),
    -- The order of films follows from it.
    secret TEXT NOT NULL,
    -- Whether readers see vertebrae that the program proposes, and may accept them.
    proposals INTEGER NOT NULL CHECK (proposals IN (0, 1)),
    is_current INTEGER NOT NULL CHECK (is_current IN (0, 1))
) STRICT;
CREATE UNIQUE INDEX one_current_plan ON plans (study) WHERE is_current = 1;

CREATE TABLE slots (
    code TEXT PRIMARY KEY,
    plan INTEGER NOT NULL REFERENCES plans (id),
    observer TEXT NOT NULL,
    place INTEGER NOT NULL CHECK (place >= 1),
    film INTEGER NOT NULL REFERENCES films (id),
    repeat INTEGER NOT NULL CHECK (repeat >= 1),
    UNIQUE (plan, observer, place),
    UNIQUE (plan, film, observer, repeat)
) STRICT;

-- Model options of a study: a JSON array of names and values, which differ from the defaults. Edits are numbered, so that a
-- stale one is noticed. A study without a row has the defaults.
CREATE TABLE options (
    study TEXT PRIMARY KEY REFERENCES studies (id),
    chosen TEXT NOT NULL,
    revision INTEGER NOT NULL
) STRICT;

-- Results of long computations on a study. They can be computed again, so the log does not cover these rows. The digest
-- covers all inputs and the result, so that neither stale nor damaged rows are used.
CREATE TABLE computations (
    study TEXT NOT NULL REFERENCES studies (id),
    kind TEXT NOT NULL,
    asked INTEGER NOT NULL,
    digest TEXT NOT NULL,
    found TEXT NOT NULL,
    PRIMARY KEY (study, kind)
) STRICT;

-- Accounts, what they may do in which study, and who is signed in.

CREATE TABLE accounts (
    name TEXT PRIMARY KEY,
    role TEXT NOT NULL CHECK (role IN ('reader', 'editor', 'admin')),
    password TEXT NOT NULL,
    enabled INTEGER NOT NULL CHECK (enabled IN (0, 1))
) STRICT;

-- The name may be an observer without an account, who made a study with the terminal's token. A revoked grant keeps its
-- row without a role, because the log has its entries.
CREATE TABLE grants (
    id INTEGER PRIMARY KEY,
    study TEXT NOT NULL REFERENCES studies (id),
    name TEXT NOT NULL,
    role TEXT CHECK (role IN ('reader', 'editor')),
    UNIQUE (study, name)
) STRICT;
CREATE INDEX grants_by_name ON grants (name);

-- Who is signed in, by the SHA-256 of the secret in their cookie. The log does not cover these rows.
CREATE TABLE sessions (
    secret_hash TEXT PRIMARY KEY,
    name TEXT NOT NULL,
    access TEXT NOT NULL CHECK (access IN ('token', 'accounts')),
    begun_ms INTEGER NOT NULL,
    used_ms INTEGER NOT NULL
) STRICT;
CREATE INDEX sessions_by_name ON sessions (name);

-- What is never changed.

CREATE TRIGGER audit_is_never_edited BEFORE UPDATE ON audit
BEGIN SELECT RAISE (ABORT, 'the audit log is append-only'); END;
CREATE TRIGGER audit_is_never_deleted BEFORE DELETE ON audit
BEGIN SELECT RAISE (ABORT, 'the audit log is append-only'); END;
CREATE TRIGGER events_are_never_edited BEFORE UPDATE ON events
BEGIN SELECT RAISE (ABORT, 'events are append-only'); END;
CREATE TRIGGER events_are_never_deleted BEFORE DELETE ON events
BEGIN SELECT RAISE (ABORT, 'events are append-only'); END;
CREATE TRIGGER finished_readings_are_never_edited BEFORE UPDATE ON readings
WHEN OLD.finished_ms IS NOT NULL
BEGIN SELECT RAISE (ABORT, 'a finished reading is immutable'); END;
CREATE TRIGGER finished_readings_get_no_events BEFORE INSERT ON events
WHEN (SELECT finished_ms FROM readings WHERE id = NEW.reading) IS NOT NULL
BEGIN SELECT RAISE (ABORT, 'a finished reading is immutable'); END;
CREATE TRIGGER withdrawn_readings_get_no_events BEFORE INSERT ON events
WHEN EXISTS (SELECT 1 FROM withdrawals WHERE reading = NEW.reading)
BEGIN SELECT RAISE (ABORT, 'a withdrawn reading is immutable'); END;
CREATE TRIGGER readings_are_never_deleted BEFORE DELETE ON readings
BEGIN SELECT RAISE (ABORT, 'readings are never deleted'); END;
CREATE TRIGGER withdrawals_are_never_edited BEFORE UPDATE ON withdrawals
BEGIN SELECT RAISE (ABORT, 'withdrawals are append-only'); END;
CREATE TRIGGER withdrawals_are_never_deleted BEFORE DELETE ON withdrawals
BEGIN SELECT RAISE (ABORT, 'withdrawals are append-only'); END;
CREATE TRIGGER conflicts_are_never_edited BEFORE UPDATE ON conflicts
BEGIN SELECT RAISE (ABORT, 'conflicts are append-only'); END;
CREATE TRIGGER conflicts_are_never_deleted BEFORE DELETE ON conflicts
BEGIN SELECT RAISE (ABORT, 'conflicts are append-only'); END;
CREATE TRIGGER accounts_are_never_deleted BEFORE DELETE ON accounts
BEGIN SELECT RAISE (ABORT, 'accounts are disabled, never deleted'); END;
CREATE TRIGGER grants_are_never_deleted BEFORE DELETE ON grants
BEGIN SELECT RAISE (ABORT, 'grants are taken back, never deleted'); END;
CREATE TRIGGER options_are_never_deleted BEFORE DELETE ON options
BEGIN SELECT RAISE (ABORT, 'options are reset, never deleted'); END;
