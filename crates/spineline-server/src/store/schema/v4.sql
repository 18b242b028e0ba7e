-- Schema 4: small pictures of films, so that a list of studies need not decode every film again.

-- Drawn from the contents and drawn again when they are missing. These rows are no record: the log does not know them.
CREATE TABLE thumbnails (
    content TEXT PRIMARY KEY REFERENCES contents (hash),
    plain BLOB NOT NULL,
    inverted BLOB NOT NULL
) STRICT;
