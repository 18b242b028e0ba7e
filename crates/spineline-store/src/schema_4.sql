-- From schema 3 to 4: a film may be the lateral one, whose `posture` is `lateral`, and journals may hold its corners and pedicles, which older
-- programs take for damage. No row and no entry of the log changes.

-- A study has one lateral film.
CREATE UNIQUE INDEX one_lateral_film ON films (study) WHERE posture = 'lateral';
