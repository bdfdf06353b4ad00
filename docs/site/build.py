#!/usr/bin/python3
"""Builds the site that ./zwang docs opens: build.py SOURCE OUTPUT. Needs mkdocs-material and doxygen.

README.md becomes index.md. Links that leave docs/ have no page in the site: headers lead to the API reference's list of
files, everything else stays as text. What is built asks no host for anything (tests/docs/site.py checks it).
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys

source, output = (pathlib.Path(name).resolve() for name in sys.argv[1:3])
pages, site, scratch = output / "pages", output / "site", output / "site-new"
for folder in (pages, scratch):
    shutil.rmtree(folder, ignore_errors=True)
shutil.copytree(source / "docs", pages, ignore=shutil.ignore_patterns("site", "CMakeLists.txt", "mkdocs.yml"))


def inside(page, text):
    """The links of a page that was at `page`, for the site."""
    def link(found):
        label, target, anchor = found[1], found[2], found[3] or ""
        file = (page.parent / target).resolve()
        if file == source / "docs/notes":
            file = source / "docs/notes/performance.md"
        if file == source / "README.md":
            file = source / "docs/index.md"
        if file.is_relative_to(source / "docs"):
            here = source / "docs" if page.name == "README.md" else page.parent
            return f"[{label}]({os.path.relpath(file, here)}{anchor})"
        return f"`{label}`" if re.fullmatch(r"[\w./-]+", label) else label
    # Code in a list item: GitHub counts from the item's text, Python's Markdown in fours.
    text = re.sub(r"(?m)^ {7}(?=\S)", " " * 8, text)
    return re.sub(r"\[([^]]*)\]\((?![a-z]+:|#)([^)#\s]+)(#[^)\s]+)?\)", link, text)


for page in sorted((source / "docs").rglob("*.md")):
    there = pages / page.relative_to(source / "docs")
    there.write_text(inside(page, page.read_text()))
(pages / "index.md").write_text(inside(source / "README.md", (source / "README.md").read_text()))
# Doxygen's pages are made after these, so mkdocs does not know them: HTML, which it leaves alone.
(pages / "api.md").write_text("""# API reference

The C++ headers, by Doxygen. `#include <zwang/...>` with the path that stands there; [library](library.md) says how to link.

- <a href="api/annotated.html">Types</a>: Problem, Solution, SolveOptions, Metrics, Scene, ...
- <a href="api/namespacezwang.html">Everything in namespace zwang</a>
- <a href="api/files.html">Headers</a>

The Python module has its own page: [Python](python.md).
""")

shutil.copy(source / "docs/site/extra.css", pages)
settings = (source / "docs/mkdocs.yml").read_text()
(output / "mkdocs.yml").write_text(f"{settings}\ndocs_dir: {pages}\nsite_dir: {scratch}\n")
subprocess.run(["mkdocs", "build", "--quiet", "--strict", "--config-file", output / "mkdocs.yml"], check=True)

doxygen = (source / "docs/site/Doxyfile").read_text()
folders = " ".join(f'"{source / name}"' for name in ("core", "constraints", "solvers", "collision", "bench", "experiments"))
(scratch / "api").mkdir()
doxygen += f'OUTPUT_DIRECTORY = "{scratch / "api"}"\nINPUT = {folders}\nSTRIP_FROM_PATH = "{source}"\n'
subprocess.run(["doxygen", "-"], input=doxygen, text=True, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

shutil.rmtree(site, ignore_errors=True)
scratch.rename(site)
print(site / "index.html")
