"""Commands of `pneurod` as a user types them, in the process of the tests."""

from typer.testing import CliRunner, Result

from pipeline.cli import app


def call(*arguments: str) -> Result:
    """How a command ended and what it printed, in a wide terminal."""
    return CliRunner().invoke(app, arguments, env={"COLUMNS": "300"})


def done(*arguments: str) -> str:
    """What a command that succeeds prints."""
    ended = call(*arguments)
    assert (ended.exit_code, ended.stderr) == (0, ""), ended.output
    return ended.stdout


def refused(*arguments: str, status: int = 2) -> str:
    """The one sentence on standard error of a command that ends with `status`, without the name of the program."""
    ended = call(*arguments)
    assert ended.exit_code == status, ended.output
    [line] = ended.stderr.splitlines()
    assert line.startswith("pneurod: ")
    return line.removeprefix("pneurod: ")
