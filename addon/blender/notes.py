"""What extraction could not carry over, each thing said once."""


class Notes:
    """Collects warnings for people; the same sentence is kept once.

    `where` names what is being read just now (an object, a material), and opens every sentence.
    """

    def __init__(self) -> None:
        self._lines: dict[str, None] = {}

    def add(self, where: str, what: str) -> None:
        """Keep `where: what`, if it was not said before."""
        self._lines[f"{where}: {what}"] = None

    @property
    def lines(self) -> tuple[str, ...]:
        """The warnings in the order in which they came up."""
        return tuple(self._lines)
