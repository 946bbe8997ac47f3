"""Pages of the documentation site that are generated from the sources (mkdocs calls these functions).

Commands, laws, messages and recipes are read from the code each time the site is built, so that the reference cannot
differ from the program. Recipes are shown with the output that they had when they were last run.
"""

from pathlib import Path

import nbformat
from commands import commands_page
from material_laws import laws_page
from messages import messages_page
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.plugins import event_priority
from mkdocs.structure.files import File, Files
from recipes import notebook_of, page_of, recipes

HERE = Path(__file__).resolve().parent.parent.parent


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the generated pages and notebooks to those of the folder docs."""
    pages = {
        "reference/commands.md": commands_page(),
        "reference/laws.md": laws_page(),
        "reference/messages.md": messages_page(HERE),
        **{f"recipes/{name}.md": page_of(name) for name in recipes()},
        **{f"recipes/{name}.ipynb": nbformat.writes(notebook_of(name)) for name in recipes()},
    }
    for address, text in pages.items():
        files.append(File.generated(config, address, content=text))
    return files


@event_priority(-100)
def on_post_build(config: MkDocsConfig) -> None:
    """Write the index of the search as a script too, which a page that is opened from a folder can load."""
    folder = Path(config.site_dir) / "search"
    index = (folder / "search_index.json").read_text(encoding="utf-8")
    (folder / "search_index.js").write_text(f"var __index = {index}", encoding="utf-8")
