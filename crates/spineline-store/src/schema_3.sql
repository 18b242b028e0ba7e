-- From schema 2 to 3: tables only, so that no row and no entry of the log changes.

-- Model options of a study: a JSON array of names and values, which differ from the defaults. Edits are numbered, so that a
-- stale one is noticed. A study without a row has the defaults.
CREATE TABLE options (
    study TEXT PRIMARY KEY REFERENCES studies (id),
    chosen TEXT NOT NULL,
    revision INTEGER NOT NULL
) STRICT;

CREATE TRIGGER options_are_never_deleted BEFORE DELETE ON options
BEGIN SELECT RAISE (ABORT, 'options are reset, never deleted'); END;

-- What was computed of a study and took long. It can be computed again: these rows are no record, and the log does not know
-- them. The digest is of everything that it was computed from and of its result, so that neither stale nor damaged
-- rows are used.
CREATE TABLE computations (
    study TEXT NOT NULL REFERENCES studies (id),
    kind TEXT NOT NULL,
    asked INTEGER NOT NULL,
    digest TEXT NOT NULL,
    found TEXT NOT NULL,
    PRIMARY KEY (study, kind)
) STRICT;
