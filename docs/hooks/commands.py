"""The page of the command line: every command with its arguments and options, from the program itself."""

from typing import Any

import typer

from pipeline.cli import app

HEADER = """# Commands

`.venv/bin/pneurod COMMAND --help` prints the same text.

| exit status | meaning |
|---|---|
| 0 | finished; warnings are in the report |
| 1 | something was not computed, for example a pressure was not reached; everything else is written |
| 2 | the input is wrong: one line on stderr for each mistake |
| 130 | interrupted; the same command continues |

`pneurod.characterize` raises `pneurod.RunFailed` for 1 and `pneurod.InputError` for 2.

`--set mesh.size="3 mm"` or `--set pressures="[17 kPa, 37 kPa]"` replaces a value of the configuration. A command
may be repeated in its folder. A folder with the results of another configuration is refused; `--fresh` replaces them.
What another command or a hand has made is refused in any case. `--jobs` is the number of worker processes.
`-q` prints nothing but the verdict, `-v` every Newton iteration, `--json` one JSON object.
"""


def commands_page() -> str:
    """The page as Markdown."""
    group: Any = typer.main.get_command(app)  # typer carries its own copy of click, without types
    return "\n".join([HEADER, *(_section(name, command) for name, command in group.commands.items())])


def _section(name: str, command: Any) -> str:
    arguments = " ".join(_shown(p) for p in command.params if p.param_type_name == "argument")
    rows = [_row(parameter) for parameter in command.params if parameter.name != "help"]
    table = ["| argument or option | default | meaning |", "|---|---|---|", *rows] if rows else []
    return "\n".join(
        [f"## {name}", "", f"    pneurod {name} {arguments}".rstrip(), "", _prose(command.help), "", *table, ""]
    )


def _shown(parameter: Any) -> str:
    name = parameter.name.upper() + ("..." if parameter.nargs == -1 else "")
    return name if parameter.required else f"[{name}]"


def _row(parameter: Any) -> str:
    if parameter.param_type_name == "argument":
        label = f"`{parameter.name.upper()}`"
    else:
        label = ", ".join(f"`{option}`" for option in (*parameter.opts, *parameter.secondary_opts))
    required = "required" if parameter.required else ""
    default = required or _default(parameter.default)
    return f"| {label} | {default} | {_prose(getattr(parameter, 'help', ''))} |"


def _default(value: object) -> str:
    if value is None or isinstance(value, bool) or value == () or value == [] or callable(value):
        return ""
    return f"`{value}`"


def _prose(text: str | None) -> str:
    """A help text on one line, safe in a table."""
    return " ".join((text or "").split()).replace("|", "\\|")
