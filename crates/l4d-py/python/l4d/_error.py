"""The one exception of the package."""

from typing import Optional


class L4dError(Exception):
    """What went wrong, where, and what to do about it.

    `message` says what; `path` is the file or folder and `field` the place in it (or the argument) where that is known;
    `hint` says what to do where more can be said than the message does.
    """

    def __init__(
        self,
        message: str,
        path: Optional[str] = None,
        field: Optional[str] = None,
        hint: Optional[str] = None,
    ) -> None:
        super().__init__(message, path, field, hint)
        self.message = message
        self.path = path
        self.field = field
        self.hint = hint

    def __str__(self) -> str:
        text = ": ".join(part for part in (self.path, self.field, self.message) if part)
        return f"{text}\nhint: {self.hint}" if self.hint else text
