"""Errors."""

from __future__ import annotations

from typing import Any


class InputError(ValueError):
    """Input that cannot be used; the text says why, where, and what to do.

    Attributes
    ----------
    help : str
        What to do about it.
    file : str or None
        The file.
    film : str or None
        The film by its posture, such as ``"left_bending"``, or ``"lateral"``.
    level : str or None
        The vertebra, such as ``"T9"``; of two, the upper one.
    value : float or None
        The value that cannot be used, in the unit of the text.
    limit : float or None
        Its limit.

    Examples
    --------
    >>> import spineline as sl
    >>> try:
    ...     sl.analyze(sl.phantom("rod", subject=1), suport="frontal")
    ... except sl.InputError as error:
    ...     print(str(error).splitlines()[0])
    unknown option `suport`; did you mean `support`?
    """

    def __init__(
        self,
        text: str,
        *,
        help: str = "",
        file: str | None = None,
        film: str | None = None,
        level: str | None = None,
        value: float | None = None,
        limit: float | None = None,
    ) -> None:
        super().__init__(text)
        self.help = help
        self.file = file
        self.film = film
        self.level = level
        self.value = value
        self.limit = limit

    def __str__(self) -> str:
        text = super().__str__()
        return f"{text}\n  help: {self.help}" if self.help else text

    def __reduce__(self) -> tuple[Any, ...]:
        return (type(self), self.args, self.__dict__)


class NotAResultError(RuntimeError):
    """A number or shape of a search that ended without a result.

    Attributes
    ----------
    status : str
        How the search ended, such as ``"limit_point"``.

    Examples
    --------
    >>> import spineline as sl
    >>> model = sl.analyze(sl.phantom("rod", subject=1)).model("inflection")
    >>> try:
    ...     model.simulate(sl.Force("T2", towards="right", force=1e6)).cobb_deg
    ... except sl.NotAResultError as error:
    ...     print(error.status)
    beyond_human_range
    """

    def __init__(self, text: str, *, status: str = "") -> None:
        super().__init__(text)
        self.status = status

    def __reduce__(self) -> tuple[Any, ...]:
        return (type(self), self.args, self.__dict__)
