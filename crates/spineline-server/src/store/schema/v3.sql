-- Schema 3: accounts, what they may do in which study, and who is signed in.

CREATE TABLE accounts (
    name TEXT PRIMARY KEY,
    role TEXT NOT NULL CHECK (role IN ('reader', 'editor', 'admin')),
    password TEXT NOT NULL,
    enabled INTEGER NOT NULL CHECK (enabled IN (0, 1))
) STRICT;

-- The name may be that of an observer who has no account: who makes a study by the token of the terminal is one. A grant
-- that was taken back has no role, so that the log still knows its row.
CREATE TABLE grants (
    id INTEGER PRIMARY KEY,
    study TEXT NOT NULL REFERENCES studies (id),
    name TEXT NOT NULL,
    role TEXT CHECK (role IN ('reader', 'editor')),
    UNIQUE (study, name)
) STRICT;
CREATE INDEX grants_by_name ON grants (name);

-- Who is signed in, by the SHA-256 of the secret in their cookie. These rows are no record: they come and go unlogged.
CREATE TABLE sessions (
    secret_hash TEXT PRIMARY KEY,
    name TEXT NOT NULL,
    access TEXT NOT NULL CHECK (access IN ('token', 'accounts')),
    begun_ms INTEGER NOT NULL,
    used_ms INTEGER NOT NULL
) STRICT;
CREATE INDEX sessions_by_name ON sessions (name);

CREATE TRIGGER accounts_are_never_deleted BEFORE DELETE ON accounts
BEGIN SELECT RAISE (ABORT, 'accounts are disabled, never deleted'); END;
CREATE TRIGGER grants_are_never_deleted BEFORE DELETE ON grants
BEGIN SELECT RAISE (ABORT, 'grants are taken back, never deleted'); END;
