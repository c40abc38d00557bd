"""The error that everything in this package raises when it is asked for what cannot be done."""


class Error(ValueError):
    """What was asked for cannot be done.

    ``field`` names what is to be mended, as ``camera.baseline_m`` or ``options.threads``; the message says how.
    """

    def __init__(self, field: str, message: str) -> None:
        super().__init__(field, message)
        self.field = field
        self.message = message

    def __str__(self) -> str:
        return f"{self.field}: {self.message}"


Error.__module__ = "motorcade"
