"""Pages of the documentation site that are generated from the sources (mkdocs calls these functions).

Commands, laws, messages and example programs are read from the code each time the site is built, so that the reference
cannot differ from the program.
"""

from pathlib import Path

from commands import commands_page
from material_laws import laws_page
from messages import messages_page
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from programs import program_page

HERE = Path(__file__).resolve().parent.parent.parent


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the generated pages to those of the folder docs."""
    pages = {
        "reference/commands.md": commands_page(),
        "reference/laws.md": laws_page(),
        "reference/messages.md": messages_page(HERE),
        **{f"examples/{path.stem}.md": program_page(path) for path in sorted((HERE / "examples").glob("*.py"))},
    }
    for address, text in pages.items():
        files.append(File.generated(config, address, content=text))
    return files
