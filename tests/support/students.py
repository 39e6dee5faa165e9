"""A program (at_seat.py) that acts as a seat of a class and evaluates expressions of a test."""

from __future__ import annotations

import ast

from robots import ROOT, Process, until

PROGRAM = str(ROOT / "tests/support/student_program.py")


class Seat:
    """The program of a seat."""

    def __init__(self, process: Process) -> None:
        self.process = process

    def expect_ready(self) -> None:
        """Wait until the program reads lines."""
        self.process.expect("ready")

    def line(self, expression: str) -> str:
        """Let the program evaluate an expression; return `= result` or `! error`."""
        self.process.say(expression)
        return self.process.expect(("= ", "! "))

    def does(self, expression: str) -> object:
        """Let the program evaluate an expression that must succeed; return its value."""
        reply = self.line(expression)
        assert reply.startswith("= "), f"{expression}: {reply}"
        value: object = ast.literal_eval(reply.removeprefix("= "))
        return value

    def refused(self, expression: str) -> str:
        """Let the program evaluate an expression that must fail; return the error."""
        reply = self.line(expression)
        assert reply.startswith("! "), f"{expression}: {reply}"
        return reply.removeprefix("! ")

    def until(self, expression: str, what: str) -> None:
        """Wait until an expression is true; errors count as false."""
        replies: list[str] = []

        def holds() -> bool:
            replies.append(self.line(expression))
            return replies[-1] == "= True"

        try:
            until(holds, what)
        except AssertionError as error:
            raise AssertionError(f"{error}; {expression}: {replies[-1]}") from None
